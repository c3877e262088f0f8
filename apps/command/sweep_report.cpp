#include "apps/command/sweep_report.h"

#include <algorithm>
#include <cstdio>

namespace carom::command {

namespace {

std::string cell_number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : c == '>' ? "&gt;" : std::string(1, c);
  return out;
}

std::string sweep_settings(const host::Declaration& d, std::span<const Varied> varied, const std::vector<double>& base,
                           std::span<const nlohmann::ordered_json> cases) {
  std::string out = "<ul>";
  for (std::size_t i = 0; i < d.parameters.size(); ++i) {
    const host::Parameter& p = d.parameters[i];
    const auto found = std::find_if(varied.begin(), varied.end(), [i](const Varied& v) { return v.parameter == i; });
    out +=
        "<li>" + std::string(found != varied.end() ? "<b>" : "") + escaped(p.label.empty() ? p.name : p.label) + ": ";
    if (found == varied.end())
      out += cell_number(base[i]);
    else
      out += std::to_string(found->values.size()) + " values from " + cell_number(found->values.front()) + " to " +
             cell_number(found->values.back());
    out += (p.unit.empty() ? "" : " " + escaped(p.unit)) + (found != varied.end() ? "</b>" : "") + "</li>";
  }
  std::size_t failed = 0;
  for (const nlohmann::ordered_json& row : cases) failed += row.contains("error");
  out += "</ul>";
  if (failed > 0) out += "<p><b>" + std::to_string(failed) + " cases ended with an error; the table names it.</b></p>";
  return out;
}

std::string sweep_table(const std::vector<std::string>& columns, std::span<const nlohmann::ordered_json> cases) {
  constexpr std::size_t most_rows = 200;
  std::string out =
      "<h2>Cases</h2><div style=\"overflow-x:auto\"><table style=\"border-collapse:collapse;font-size:13px;"
      "font-variant-numeric:tabular-nums\"><tr>";
  const std::string cell = " style=\"border-bottom:1px solid #ccd3da;padding:2px 8px;text-align:right\">";
  for (const std::string& column : columns) out += "<th scope=\"col\"" + cell + escaped(column) + "</th>";
  out += "</tr>";
  for (std::size_t i = 0; i < std::min(cases.size(), most_rows); ++i) {
    out += "<tr>";
    for (const std::string& column : columns) {
      const bool there = cases[i].contains(column);
      const nlohmann::ordered_json value = there ? cases[i].at(column) : nlohmann::ordered_json();
      out += "<td" + cell +
             (!there              ? std::string()
              : value.is_string() ? escaped(value.get<std::string>())
              : value.is_number() ? cell_number(value.get<double>())
                                  : escaped(value.dump())) +
             "</td>";
    }
    out += "</tr>";
  }
  out += "</table></div>";
  if (cases.size() > most_rows)
    out += "<p>The first " + std::to_string(most_rows) + " of " + std::to_string(cases.size()) +
           " cases; all are in the files above.</p>";
  return out;
}

}  // namespace carom::command
