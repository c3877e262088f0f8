// Sources of the factors: BIPM, The International System of Units, 9th ed. (2019), tables 2-8; NIST SP 811 (2008) app.
// B.
#include "carom/math/detail/unit_table.h"

#include <algorithm>

namespace carom::math {
namespace detail {
namespace {

namespace dim = dimensions;
constexpr Dimension charge{0, 0, 1, 0, 1}, resistance{1, 2, -3, 0, -2}, flux_density{1, 0, -2, 0, -1};
constexpr double pi_value = 3.14159265358979323846;
constexpr double pound = 0.45359237, standard_gravity = 9.80665, foot = 0.3048;

constexpr NamedUnit units[] = {
    // SI, with prefixes
    {"m", 1, 1, dim::length, true, 0, false},
    {"g", 1, 1000, dim::mass, true, 0, false},
    {"s", 1, 1, dim::time, true, 0, false},
    {"K", 1, 1, dim::temperature, true, 0, false},
    {"A", 1, 1, dim::current, true, 0, false},
    {"N", 1, 1, dim::force, true, 0, false},
    {"J", 1, 1, dim::energy, true, 0, false},
    {"W", 1, 1, dim::power, true, 0, false},
    {"Pa", 1, 1, dim::pressure, true, 0, false},
    {"Hz", 1, 1, dim::frequency, true, 0, true},
    {"V", 1, 1, dim::voltage, true, 0, false},
    {"C", 1, 1, charge, true, 0, false},
    {"ohm", 1, 1, resistance, true, 0, false},
    {"Ω", 1, 1, resistance, true, 0, false},
    {"T", 1, 1, flux_density, true, 0, false},
    {"rad", 1, 1, dim::angle, true, 0, false},
    {"L", 1, 1000, dim::volume, true, 0, false},
    {"l", 1, 1000, dim::volume, true, 0, false},
    {"bar", 100000, 1, dim::pressure, true, 0, false},
    {"eV", 1.602176634e-19, 1, dim::energy, true, 0, false},
    {"cal", 4.184, 1, dim::energy, true, 0, false},
    {"Wh", 3600, 1, dim::energy, true, 0, false},
    {"P", 1, 10, dim::dynamic_viscosity, true, 0, false},
    {"St", 1, 10000, dim::kinematic_viscosity, true, 0, false},
    // plain numbers and angles
    {"%", 1, 100, dim::none, false, 0, false},
    {"percent", 1, 100, dim::none, false, 0, false},
    {"‰", 1, 1000, dim::none, false, 0, false},
    {"deg", pi_value, 180, dim::angle, false, 0, false},
    {"°", pi_value, 180, dim::angle, false, 0, false},
    {"arcmin", pi_value, 10800, dim::angle, false, 0, false},
    {"arcsec", pi_value, 648000, dim::angle, false, 0, false},
    {"rev", 2 * pi_value, 1, dim::angle, false, 0, false},
    {"turn", 2 * pi_value, 1, dim::angle, false, 0, false},
    {"rpm", 2 * pi_value, 60, dim::angular_velocity, false, 0, false},
    // time
    {"min", 60, 1, dim::time, false, 0, false},
    {"h", 3600, 1, dim::time, false, 0, false},
    {"hr", 3600, 1, dim::time, false, 0, false},
    {"d", 86400, 1, dim::time, false, 0, false},
    {"day", 86400, 1, dim::time, false, 0, false},
    // length, area, volume
    {"in", 0.0254, 1, dim::length, false, 0, false},
    {"ft", foot, 1, dim::length, false, 0, false},
    {"yd", 0.9144, 1, dim::length, false, 0, false},
    {"mi", 1609.344, 1, dim::length, false, 0, false},
    {"nmi", 1852, 1, dim::length, false, 0, false},
    {"au", 149597870700.0, 1, dim::length, false, 0, false},
    {"ly", 9460730472580800.0, 1, dim::length, false, 0, false},
    {"ha", 10000, 1, dim::area, false, 0, false},
    {"acre", 4046.8564224, 1, dim::area, false, 0, false},
    {"gal", 0.003785411784, 1, dim::volume, false, 0, false},
    // speed and acceleration
    {"mph", 0.44704, 1, dim::speed, false, 0, false},
    {"kph", 10, 36, dim::speed, false, 0, false},
    {"fps", foot, 1, dim::speed, false, 0, false},
    {"kn", 1852, 3600, dim::speed, false, 0, false},
    {"kt", 1852, 3600, dim::speed, false, 0, false},
    {"knot", 1852, 3600, dim::speed, false, 0, false},
    {"knots", 1852, 3600, dim::speed, false, 0, false},
    {"c", 299792458, 1, dim::speed, false, 0, false},
    {"g0", standard_gravity, 1, dim::acceleration, false, 0, false},
    {"gee", standard_gravity, 1, dim::acceleration, false, 0, false},
    // mass
    {"t", 1000, 1, dim::mass, false, 0, false},
    {"tonne", 1000, 1, dim::mass, false, 0, false},
    {"lb", pound, 1, dim::mass, false, 0, false},
    {"lbm", pound, 1, dim::mass, false, 0, false},
    {"oz", pound, 16, dim::mass, false, 0, false},
    {"gr", pound, 7000, dim::mass, false, 0, false},
    {"grain", pound, 7000, dim::mass, false, 0, false},
    {"slug", pound* standard_gravity, foot, dim::mass, false, 0, false},
    {"ton", 2000 * pound, 1, dim::mass, false, 0, false},
    // force, torque, pressure
    {"lbf", 4.4482216152605, 1, dim::force, false, 0, false},
    {"ozf", 4.4482216152605, 16, dim::force, false, 0, false},
    {"kgf", standard_gravity, 1, dim::force, false, 0, false},
    {"pdl", 0.138254954376, 1, dim::force, false, 0, false},
    {"atm", 101325, 1, dim::pressure, false, 0, false},
    {"psi", 4.4482216152605, 0.00064516, dim::pressure, false, 0, false},
    {"psf", 4.4482216152605, 0.09290304, dim::pressure, false, 0, false},
    {"torr", 101325, 760, dim::pressure, false, 0, false},
    {"mmHg", 133.322387415, 1, dim::pressure, false, 0, false},
    {"inHg", 3386.388640341, 1, dim::pressure, false, 0, false},
    // power and energy
    {"hp", 745.69987158227022, 1, dim::power, false, 0, false},
    {"PS", 735.49875, 1, dim::power, false, 0, false},
    {"BTU", 1055.05585262, 1, dim::energy, false, 0, false},
    // temperature
    {"degC", 1, 1, dim::temperature, false, 273.15, false},
    {"°C", 1, 1, dim::temperature, false, 273.15, false},
    {"℃", 1, 1, dim::temperature, false, 273.15, false},
    {"degF", 5, 9, dim::temperature, false, 459.67, false},
    {"°F", 5, 9, dim::temperature, false, 459.67, false},
    {"degR", 5, 9, dim::temperature, false, 0, false},
    {"delta_degC", 1, 1, dim::temperature, false, 0, false},
    {"delta_degF", 5, 9, dim::temperature, false, 0, false},
};

struct Prefix {
  std::string_view name;
  double numerator, denominator;
};
constexpr Prefix prefixes[] = {{"da", 10, 1},  {"h", 100, 1}, {"k", 1000, 1}, {"M", 1e6, 1},  {"G", 1e9, 1},
                               {"T", 1e12, 1}, {"d", 1, 10},  {"c", 1, 100},  {"m", 1, 1000}, {"u", 1, 1e6},
                               {"µ", 1, 1e6},  {"μ", 1, 1e6}, {"n", 1, 1e9},  {"p", 1, 1e12}};

Unit unit_of(const NamedUnit& u, double numerator, double denominator) {
  const Pair scale = quotient(two_product(u.numerator, numerator), two_product(u.denominator, denominator));
  return {scale, u.offset, u.dimension, u.counts_cycles};
}

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Twice the Damerau–Levenshtein distance (a swap of neighbours counts once), where a change of case alone costs half.
int doubled_distance(std::string_view a, std::string_view b) {
  constexpr std::size_t longest = 32;
  if (a.size() > longest || b.size() > longest) return 1000;
  int d[longest + 1][longest + 1];
  for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = static_cast<int>(2 * i);
  for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = static_cast<int>(2 * j);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const char x = a[i - 1], y = b[j - 1];
      const int change = d[i - 1][j - 1] + (x == y ? 0 : (lower(x) == lower(y) ? 1 : 2));
      d[i][j] = std::min(change, std::min(d[i - 1][j], d[i][j - 1]) + 2);
      if (i > 1 && j > 1 && x == b[j - 2] && a[i - 2] == y) d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 2);
    }
  }
  return d[a.size()][b.size()];
}

}  // namespace

bool find_unit(std::string_view name, Unit& unit) {
  for (const NamedUnit& u : units) {
    if (u.name == name) {
      unit = unit_of(u, 1, 1);
      return true;
    }
  }
  for (const Prefix& p : prefixes) {
    if (name.size() <= p.name.size() || name.substr(0, p.name.size()) != p.name) continue;
    const std::string_view rest = name.substr(p.name.size());
    for (const NamedUnit& u : units) {
      if (u.prefixable && u.name == rest) {
        unit = unit_of(u, p.numerator, p.denominator);
        return true;
      }
    }
  }
  return false;
}

std::string nearest_unit(std::string_view name) {
  std::string best;
  int least = name.size() <= 2 ? 3 : 5;  // up to one wrong letter in a short name, two in a longer one
  const auto consider = [&](const std::string& candidate) {
    const int d = doubled_distance(name, candidate);
    if (d < least || (d == least && candidate.size() == name.size() && best.size() != name.size())) {
      least = d;
      best = candidate;
    }
  };
  for (const NamedUnit& u : units) consider(std::string(u.name));
  for (const NamedUnit& u : units) {
    if (!u.prefixable) continue;
    for (const std::string_view p : {"k", "M", "m", "c"}) consider(std::string(p) + std::string(u.name));
  }
  return best;
}

}  // namespace detail

std::vector<std::string_view> unit_names() {
  std::vector<std::string_view> names;
  for (const detail::NamedUnit& u : detail::units) names.push_back(u.name);
  return names;
}

}  // namespace carom::math
