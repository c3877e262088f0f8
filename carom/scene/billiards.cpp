#include "carom/scene/billiards.h"

#include <span>
#include <string>

#include "carom/core/string.h"
#include "carom/scene/detail/document.h"
#include "carom/scene/detail/quantity.h"
#include "carom/sports/billiards_engine.h"

namespace carom::scene {

namespace {

using detail::Measure;
using detail::Node;

/// A number of a preset, and where it goes.
struct TableNumber {
  const char* name;
  Measure measure;
  double* to;
};

class PresetReader {
 public:
  PresetReader(std::string_view text, std::string_view name) : name_(name) { open(text); }

  void open(std::string_view text) {
    core::Result<Node> read = detail::parse_document(text, name_, 0, {.bytes = 1u << 20, .nodes = 4096});
    if (!read) {
      fail(read.error().message);
      return;
    }
    root_ = std::move(*read);
    if (!root_.is_object()) return refuse(root_, "the file", "an object with description, source and values");
    for (std::size_t i = 0; i < root_.keys.size(); ++i) {
      const std::string& key = root_.keys[i];
      if (key == "values") continue;
      if (key != "description" && key != "source")
        return refuse(root_.children[i], key, "only the keys description, source and values");
      if (!root_.children[i].is_text()) return refuse(root_.children[i], key, "a text");
    }
    const Node* values = root_.find("values");
    if (values == nullptr) return refuse(root_, "values", "an object of this name");
    if (!values->is_object()) return refuse(*values, "values", "an object");
    values_ = values;
  }

  /// Null after an error.
  const Node* values() const { return ok() ? values_ : nullptr; }
  bool ok() const { return error_.empty(); }
  core::Error error() const { return core::Error{error_}; }
  void fail(std::string message) {
    if (error_.empty()) error_ = std::move(message);
  }
  void fail_at_values(const std::string& message) {
    fail(core::text(name_, ":", values_ != nullptr ? values_->line : 1, ": ", message));
  }
  void refuse(const Node& at, std::string_view path, std::string_view expected) {
    fail(core::text(name_, ":", at.line, ": ", path, ": found ", detail::show(at), ", expected ", expected));
  }

  void numbers(const Node& object, const std::string& path, std::span<const TableNumber> known,
               std::span<const char* const> others = {}) {
    for (std::size_t i = 0; i < object.keys.size() && ok(); ++i) {
      const std::string& key = object.keys[i];
      const Node& value = object.children[i];
      const TableNumber* found = nullptr;
      for (const TableNumber& k : known)
        if (key == k.name) found = &k;
      if (found != nullptr) {
        read(value, path + key, *found);
        continue;
      }
      bool other = false;
      for (const char* o : others) other = other || key == o;
      if (other) continue;
      std::string names;
      for (const TableNumber& k : known) names += names.empty() ? k.name : std::string(", ") + k.name;
      for (const char* o : others) names += std::string(", ") + o;
      refuse(value, path + key, "one of the keys " + names);
    }
  }
  bool flag(const Node& object, const char* key, bool before) {
    const Node* at = object.find(key);
    if (at == nullptr) return before;
    if (at->kind != detail::NodeKind::boolean) refuse(*at, key, "true or false");
    return at->truth;
  }
  const Node* part(const Node& object, const char* key) {
    const Node* at = object.find(key);
    if (at != nullptr && !at->is_object()) refuse(*at, key, "an object");
    return ok() ? at : nullptr;
  }

 private:
  void read(const Node& at, const std::string& path, const TableNumber& to) {
    const detail::MeasureInfo& info = detail::measure_info(to.measure);
    const std::string wanted =
        info.sample[0] != 0 ? core::text(info.article, " such as \"", info.sample, "\"") : std::string(info.article);
    double value = at.number;
    if (at.is_text()) {
      const core::Result<detail::Quantity> q = detail::parse_quantity(at.text);
      if (!q || !(q->dimension == detail::measure_dimension(to.measure))) return refuse(at, path, wanted);
      value = q->value;
    } else if (at.kind != detail::NodeKind::number) {
      return refuse(at, path, wanted);
    }
    if (!math::is_finite(value)) return refuse(at, path, "a finite number");
    *to.to = value;
  }

  std::string name_, error_;
  Node root_;
  const Node* values_ = nullptr;
};

void read_cloth_numbers(PresetReader& in, const Node& at, const std::string& path, sports::Cloth& cloth) {
  const TableNumber known[] = {{"sliding_friction", Measure::plain, &cloth.sliding_friction},
                               {"rolling_friction", Measure::plain, &cloth.rolling_friction},
                               {"spinning_friction", Measure::plain, &cloth.spinning_friction},
                               {"restitution", Measure::plain, &cloth.restitution},
                               {"bounce_threshold", Measure::speed, &cloth.bounce_threshold}};
  in.numbers(at, path, known);
}

}  // namespace

core::Result<BilliardSetting> read_billiard_table(std::string_view text, std::string_view name,
                                                  const BilliardSetting& before) {
  BilliardSetting s = before;
  PresetReader in(text, name);
  const Node* values = in.values();
  if (values == nullptr) return in.error();
  sports::RectangularTable& t = s.table;
  const TableNumber known[] = {{"length", Measure::length, &t.length},
                               {"width", Measure::length, &t.width},
                               {"nose_height", Measure::length, &t.nose_height},
                               {"rail_width", Measure::length, &t.rail_width},
                               {"corner_mouth", Measure::length, &t.corner_mouth},
                               {"corner_angle", Measure::angle, &t.corner_angle},
                               {"corner_depth", Measure::length, &t.corner_depth},
                               {"corner_radius", Measure::length, &t.corner_radius},
                               {"corner_rounding", Measure::length, &t.corner_rounding},
                               {"side_mouth", Measure::length, &t.side_mouth},
                               {"side_angle", Measure::angle, &t.side_angle},
                               {"side_depth", Measure::length, &t.side_depth},
                               {"side_radius", Measure::length, &t.side_radius},
                               {"side_rounding", Measure::length, &t.side_rounding}};
  constexpr const char* parts[] = {"pockets", "ball", "cloth", "balls", "cushion"};
  in.numbers(*values, "", known, parts);
  t.pockets = in.flag(*values, "pockets", t.pockets);
  sports::BilliardPhysics& p = s.physics;
  if (const Node* at = in.part(*values, "ball")) {
    const TableNumber ball[] = {{"mass", Measure::mass, &p.ball.mass}, {"radius", Measure::length, &p.ball.radius}};
    in.numbers(*at, "ball.", ball);
  }
  if (const Node* at = in.part(*values, "cloth")) read_cloth_numbers(in, *at, "cloth.", p.cloth);
  if (const Node* at = in.part(*values, "balls")) {
    const TableNumber balls[] = {{"restitution", Measure::plain, &p.balls.restitution},
                                 {"friction_floor", Measure::plain, &p.balls.friction_floor},
                                 {"friction_range", Measure::plain, &p.balls.friction_range},
                                 {"friction_rate", Measure::plain, &p.balls.friction_rate},
                                 {"contact_time", Measure::time, &p.balls.contact_time}};
    in.numbers(*at, "balls.", balls);
  }
  if (const Node* at = in.part(*values, "cushion")) {
    const TableNumber cushion[] = {{"restitution", Measure::plain, &p.cushion.restitution},
                                   {"friction", Measure::plain, &p.cushion.friction},
                                   {"frequency_ratio", Measure::plain, &p.cushion.frequency_ratio}};
    constexpr const char* model[] = {"model"};
    in.numbers(*at, "cushion.", cushion, model);
    if (const Node* named = at->find("model")) {
      constexpr const char* models[] = {"stronge", "mathavan", "han"};
      int which = -1;
      for (int i = 0; i < 3; ++i)
        if (named->is_text() && named->text == models[i]) which = i;
      if (which < 0) in.refuse(*named, "cushion.model", "\"stronge\", \"mathavan\" or \"han\"");
      if (which >= 0) p.cushion.model = sports::CushionModel(which);
    }
  }
  if (!in.ok()) return in.error();
  const auto table = sports::BilliardTable::create(t);
  if (!table) {
    in.fail_at_values(table.error().message);
  } else if (const auto game = sports::Billiards::create(*table, p); !game) {
    in.fail_at_values(game.error().message);
  }
  if (!in.ok()) return in.error();
  return s;
}

core::Result<sports::Cloth> read_cloth(std::string_view text, std::string_view name, const sports::Cloth& before) {
  sports::BilliardPhysics p;
  p.cloth = before;
  PresetReader in(text, name);
  const Node* values = in.values();
  if (values == nullptr) return in.error();
  read_cloth_numbers(in, *values, "", p.cloth);
  if (const core::Status good = sports::validate(p); in.ok() && !good) in.fail_at_values(good.error().message);
  if (!in.ok()) return in.error();
  return p.cloth;
}

core::Result<sports::Cue> read_cue(std::string_view text, std::string_view name, const sports::Cue& before) {
  sports::Cue cue = before;
  PresetReader in(text, name);
  const Node* values = in.values();
  if (values == nullptr) return in.error();
  const TableNumber known[] = {{"mass", Measure::mass, &cue.mass},
                               {"end_mass", Measure::mass, &cue.end_mass},
                               {"tip_friction", Measure::plain, &cue.tip_friction},
                               {"restitution", Measure::plain, &cue.restitution}};
  in.numbers(*values, "", known);
  if (const auto good = sports::strike_cue({}, cue, {}); in.ok() && !good) in.fail_at_values(good.error().message);
  if (!in.ok()) return in.error();
  return cue;
}

}  // namespace carom::scene
