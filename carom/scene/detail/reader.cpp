#include "carom/scene/detail/reader.h"

#include <cstdlib>

#include "carom/core/spelling.h"
#include "carom/math/elementary.h"

namespace carom::scene::detail {
namespace {

/// "a body", "an effector".
std::string with_article(std::string_view name) {
  const bool vowel = !name.empty() && std::string_view("aeiou").find(name[0]) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(name);
}

}  // namespace

std::string Object::path_of(std::string_view key) const {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

std::string index_path(std::string_view path, std::size_t index) {
  return std::string(path) + "[" + std::to_string(index) + "]";
}

void Reader::fail(const Node& at, std::string_view path, std::string_view message) {
  if (failed_) return;
  failed_ = true;
  const std::string& file = document_.files[at.file];
  error_ = file + ":" + std::to_string(at.line) + ": ";
  if (!path.empty()) error_ += std::string(path) + ": ";
  error_ += message;
}

void Reader::expected(const Node& at, std::string_view path, std::string_view what, std::string_view hint) {
  if (failed_) return;
  fail(at, path, "found " + show(at) + ", expected " + std::string(what) + std::string(hint));
}

bool Reader::accept(const core::Status& status, const Node& at, std::string_view path) {
  if (!status) fail(at, path, status.error().message);
  return status.ok();
}

const Field& Reader::field(const Object& o, std::string_view key) const {
  const Field* found = o.kind->find(key);
  if (found == nullptr) {
    // Reading a key that the table does not list is a mistake in this room, never in a file.
    std::fprintf(stderr, "carom: the table of %s has no field %.*s\n", o.kind->name, int(key.size()), key.data());
    std::abort();
  }
  return *found;
}

bool Reader::open(const Node& node, std::string path, const ObjectKind& kind, Object& out) {
  out = Object{&node, std::move(path), &kind};
  if (failed_) return false;
  if (!node.is_object()) {
    expected(node, out.path, std::string("an object (") + kind.name + ")");
    return false;
  }
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const Field* known = kind.find(node.keys[i]);
    if (known == nullptr) {
      std::vector<std::string_view> names;
      for (const Field& f : kind.fields) names.push_back(f.name);
      fail(node.children[i], out.path_of(node.keys[i]),
           "found the unknown key " + quote(node.keys[i].substr(0, 60)) + " in " + with_article(kind.name) +
               core::did_you_mean(node.keys[i], names));
      return false;
    }
    if (known->dimensions != 0 && known->dimensions != dimension) {
      fail(node.children[i], out.path_of(node.keys[i]),
           std::string("found a key that only a scene of dimension ") + char('0' + known->dimensions) + " has");
      return false;
    }
  }
  for (const Field& f : kind.fields) {
    if (f.required && node.find(f.name) == nullptr) {
      fail(node, out.path, std::string("the key ") + quote(f.name) + " is missing in " + with_article(kind.name));
      return false;
    }
  }
  return true;
}

double Reader::number(const Object& o, std::string_view key, double fallback) {
  return number(o, key, fallback, field(o, key).measure);
}

double Reader::number(const Object& o, std::string_view key, double fallback, Measure measure) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  return node == nullptr ? fallback : value(*node, o.path_of(key), measure);
}

namespace {
double whole(Reader& reader, const Object& o, std::string_view key, double fallback, double low, double high) {
  const Node* node = reader.failed() ? nullptr : o.find(key);
  if (node == nullptr) return fallback;
  const double found = reader.value(*node, o.path_of(key), Measure::plain);
  if (reader.failed()) return fallback;
  if (found == __builtin_floor(found) && found >= low && found <= high) return found;
  reader.expected(
      *node, o.path_of(key),
      "a whole number from " + std::to_string(std::int64_t(low)) + " to " + std::to_string(std::int64_t(high)));
  return fallback;
}
}  // namespace

int Reader::integer(const Object& o, std::string_view key, int fallback, int low, int high) {
  field(o, key);
  return int(whole(*this, o, key, fallback, low, high));
}

std::uint32_t Reader::user_id(const Object& o) {
  field(o, "user_id");
  return std::uint32_t(whole(*this, o, "user_id", 0, 0, 0xFFFFFFFF));
}

bool Reader::flag(const Object& o, std::string_view key, bool fallback) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return fallback;
  if (node->kind == NodeKind::boolean) return node->truth;
  if (node->is_text() && !node->text.empty() && (node->text[0] == '=' || node->text[0] == '$'))
    return value(*node, o.path_of(key), Measure::plain) != 0;
  expected(*node, o.path_of(key), "true or false");
  return fallback;
}

std::string Reader::text(const Object& o, std::string_view key, std::string_view fallback) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return std::string(fallback);
  if (!node->is_text()) {
    expected(*node, o.path_of(key), "a text");
    return std::string(fallback);
  }
  return expand(*node, o.path_of(key), node->text);
}

std::string Reader::expand(const Node& node, std::string_view path, std::string_view text) {
  if (variables.empty() || text.find('{') == std::string_view::npos) return std::string(text);
  std::string out;
  while (!text.empty() && !failed_) {
    const std::size_t open = text.find('{');
    out += text.substr(0, open);
    if (open == std::string_view::npos) break;
    const std::size_t close = text.find('}', open);
    if (close == std::string_view::npos) {
      expected(node, path, "a \"}\" for every \"{\"");
      break;
    }
    const Quantity q = evaluate(node, path, text.substr(open + 1, close - open - 1));
    const bool whole = q.value == __builtin_floor(q.value) && math::abs(q.value) < 1e15;
    out += whole ? std::to_string(static_cast<long long>(q.value)) : shortest(q.value);
    text.remove_prefix(close + 1);
  }
  return out;
}

int Reader::choice(const Object& o, std::string_view key, int fallback) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return fallback;
  if (node->is_text())
    for (std::size_t i = 0; i < f.choices.size(); ++i)
      if (f.choices[i] == node->text) return int(i);
  std::string list = "one of ";
  for (std::size_t i = 0; i < f.choices.size(); ++i) list += (i == 0 ? "" : ", ") + std::string(f.choices[i]);
  expected(*node, o.path_of(key), list, node->is_text() ? core::did_you_mean(node->text, f.choices) : "");
  return fallback;
}

std::uint64_t Reader::bits(const Object& o, std::string_view key, std::uint64_t fallback) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return fallback;
  const auto bad = [&] {
    expected(*node, o.path_of(key),
             "a whole number, a hexadecimal text such as \"0xff\", or a list of bit numbers 0 to 63");
    return fallback;
  };
  if (node->kind == NodeKind::number) {
    if (node->number < 0 || node->number > 0x1p53 || node->number != __builtin_floor(node->number)) return bad();
    return std::uint64_t(node->number);
  }
  if (node->is_array()) {
    std::uint64_t mask = 0;
    for (const Node& bit : node->children) {
      if (bit.kind != NodeKind::number || bit.number < 0 || bit.number > 63 ||
          bit.number != __builtin_floor(bit.number))
        return bad();
      mask |= std::uint64_t{1} << int(bit.number);
    }
    return mask;
  }
  if (!node->is_text() || node->text.size() < 3 || node->text.size() > 18 || node->text.compare(0, 2, "0x") != 0)
    return bad();
  std::uint64_t mask = 0;
  for (const char c : std::string_view(node->text).substr(2)) {
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    if (digit < 0) return bad();
    mask = mask << 4 | std::uint64_t(digit);
  }
  return mask;
}

std::optional<std::uint32_t> Reader::color(const Object& o, std::string_view key) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return std::nullopt;
  std::uint32_t rgb = 0;
  bool good = node->is_text();
  const std::string found = good ? expand(*node, o.path_of(key), node->text) : std::string();
  good = good && (found.size() == 7 || found.size() == 9) && found[0] == '#';
  for (std::size_t i = 1; good && i < found.size(); ++i) {
    const char c = found[i];
    const int digit = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    good = digit >= 0;
    rgb = rgb << 4 | std::uint32_t(digit & 15);
  }
  // The file ends with the opacity, we begin with it; without one a color is solid.
  if (good) return found.size() == 7 ? 0xff000000u | rgb : rgb << 24 | rgb >> 8;
  expected(*node, o.path_of(key), "a color such as \"#c04020\", or \"#c0402080\" with an opacity");
  return std::nullopt;
}

math::Vec3d Reader::vector_of(const Node& node, std::string_view path, Measure measure) {
  if (failed_) return {};
  if (!node.is_array() || node.children.size() != std::size_t(dimension)) {
    const MeasureInfo& info = measure_info(measure);
    expected(node, path, std::string("a list of ") + (dimension == 2 ? "two" : "three") + ", each " + info.article);
    return {};
  }
  math::Vec3d v;
  for (int i = 0; i < dimension; ++i)
    v[i] = value(node.children[std::size_t(i)], index_path(path, std::size_t(i)), measure);
  return v;
}

math::Vec3d Reader::vector(const Object& o, std::string_view key, math::Vec3d fallback) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  return node == nullptr ? fallback : vector_of(*node, o.path_of(key), f.measure);
}

math::Vec3d Reader::angular(const Object& o, std::string_view key) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return {};
  if (dimension == 2) return {0, 0, value(*node, o.path_of(key), f.measure)};
  return vector_of(*node, o.path_of(key), f.measure);
}

math::Rot2f Reader::rotation2(const Object& o, std::string_view key) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return {};
  const std::string path = o.path_of(key);
  if (node->is_array()) {
    if (node->children.size() != 2) return expected(*node, path, "an angle, or cosine and sine"), math::Rot2f{};
    const math::Rot2d q{value(node->children[0], index_path(path, 0), Measure::plain),
                        value(node->children[1], index_path(path, 1), Measure::plain)};
    const double length = q.c * q.c + q.s * q.s;
    if (!failed_ && !(length > 0.98 && length < 1.02)) fail(*node, path, "cosine and sine are not on the unit circle");
    // What is of unit length already keeps its bits.
    return math::abs(length - 1) < 1e-6 ? math::Rot2f(q) : math::Rot2f(math::normalize(q));
  }
  double angle = 0;
  Object r;
  if (node->is_object()) {
    if (!open(*node, path, *tables().rotation, r)) return {};
    angle = number(r, "angle", 0);
  } else {
    angle = value(*node, path, Measure::angle);
  }
  const math::SinCos<double> turn = math::sincos(angle);
  return math::Rot2f(math::Rot2d{turn.cos, turn.sin});
}

math::Quatf Reader::rotation3(const Object& o, std::string_view key) {
  field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return {};
  const std::string path = o.path_of(key);
  const auto about = [](math::Vec3d axis, double angle) {
    const math::SinCos<double> half = math::sincos(angle / 2);
    return math::Quatd{half.cos, axis * half.sin};
  };
  const auto listed = [&](const Node& list, const std::string& at) {
    math::Quatd q;
    if (!list.is_array() || list.children.size() != 4) {
      expected(list, at, "four numbers: w, x, y, z");
      return math::Quatf{};
    }
    q.w = value(list.children[0], index_path(at, 0), Measure::plain);
    q.x = value(list.children[1], index_path(at, 1), Measure::plain);
    q.y = value(list.children[2], index_path(at, 2), Measure::plain);
    q.z = value(list.children[3], index_path(at, 3), Measure::plain);
    const double length = dot(q, q);
    if (!failed_ && !(length > 1e-12 && length < 1e12)) fail(list, at, "the quaternion has no usable length");
    // What is of unit length already keeps its bits.
    return math::abs(length - 1) < 1e-6 ? math::Quatf(q) : math::Quatf(math::normalize(q));
  };
  if (node->is_array()) return listed(*node, path);
  Object r;
  if (!open(*node, path, *tables().rotation, r)) return {};
  if (r.has("quaternion")) return listed(*r.find("quaternion"), r.path_of("quaternion"));
  if (r.has("axis") || r.has("angle")) {
    const math::Vec3d axis = math::normalize(vector(r, "axis", {0, 1, 0}));
    if (!failed_ && axis == math::Vec3d{}) fail(*node, path, "the axis has no direction");
    return math::Quatf(about(axis, number(r, "angle", 0)));
  }
  const double yaw = number(r, "yaw", 0);
  const double pitch = number(r, "pitch", 0);
  const double roll = number(r, "roll", 0);
  return math::Quatf(math::normalize(about({0, 1, 0}, yaw) * about({0, 0, 1}, pitch) * about({1, 0, 0}, roll)));
}

std::vector<math::Vec3d> Reader::points_of(const Node& list, const std::string& path, Measure measure) {
  std::vector<math::Vec3d> out;
  if (!list.is_array()) return expected(list, path, "a list of points"), out;
  out.reserve(list.children.size());
  for (std::size_t i = 0; i < list.children.size() && !failed_; ++i)
    out.push_back(vector_of(list.children[i], index_path(path, i), measure));
  return out;
}

std::vector<math::Vec3d> Reader::points(const Object& o, std::string_view key) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  if (node == nullptr) return {};
  return points_of(*node, o.path_of(key), f.measure);
}

std::vector<std::vector<math::Vec3d>> Reader::point_lists(const Object& o, std::string_view key) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  std::vector<std::vector<math::Vec3d>> out;
  if (node == nullptr) return out;
  const std::string path = o.path_of(key);
  if (!node->is_array()) return expected(*node, path, "a list of lists of points"), out;
  for (std::size_t i = 0; i < node->children.size() && !failed_; ++i)
    out.push_back(points_of(node->children[i], index_path(path, i), f.measure));
  return out;
}

std::vector<double> Reader::numbers(const Object& o, std::string_view key, int count) {
  const Field& f = field(o, key);
  const Node* node = failed_ ? nullptr : o.find(key);
  std::vector<double> out;
  if (node == nullptr) return out.resize(std::size_t(count < 0 ? 0 : count)), out;
  const std::string path = o.path_of(key);
  if (!node->is_array() || (count >= 0 && node->children.size() != std::size_t(count))) {
    expected(*node, path, count >= 0 ? "a list of " + std::to_string(count) : std::string("a list"));
    out.assign(std::size_t(count < 0 ? 0 : count), 0.0);
    return out;
  }
  out.reserve(node->children.size());
  for (std::size_t i = 0; i < node->children.size() && !failed_; ++i)
    out.push_back(value(node->children[i], index_path(path, i), f.measure));
  if (count >= 0) out.resize(std::size_t(count));
  return out;
}

bool Reader::wanted(const Object& o) { return number(o, "if", 1) != 0; }

Quantity Reader::evaluate(const Node& node, std::string_view path, std::string_view text) {
  if (failed_) return {};
  const core::Result<Expression> expression = parse_expression(text);
  if (!expression) {
    fail(node, path, "found " + show(node) + ": " + expression.error().message);
    return {};
  }
  std::vector<Dimension> dimensions;
  std::vector<double> values;
  for (const std::string& name : expression->names) {
    const Variable* found = nullptr;
    for (const Variable& v : variables)
      if (v.name == name) found = &v;
    if (found == nullptr) {
      std::vector<std::string_view> known;
      for (const Variable& v : variables) known.push_back(v.name);
      fail(node, path, "found the name " + quote(name) + " that is no parameter" + core::did_you_mean(name, known));
      return {};
    }
    dimensions.push_back(found->dimension);
    values.push_back(found->value);
  }
  const core::Result<Dimension> dimension = check_expression(*expression, dimensions);
  if (!dimension) {
    fail(node, path, "found " + show(node) + ": " + dimension.error().message);
    return {};
  }
  const double result = evaluate_expression(*expression, values);
  if (!math::is_finite(result)) {
    fail(node, path, "found " + show(node) + ", whose value is not finite");
    return {};
  }
  return {result, *dimension};
}

Quantity Reader::any_value(const Node& node, std::string_view path) {
  if (failed_) return {};
  if (node.kind == NodeKind::number) return {node.number, Dimension{}};
  if (!node.is_text()) {
    expected(node, path, "a quantity: a number, or a text with number and unit");
    return {};
  }
  if (!node.text.empty() && (node.text[0] == '=' || node.text[0] == '$'))
    return evaluate(node, path, std::string_view(node.text).substr(1));
  const core::Result<Quantity> quantity = parse_quantity(node.text);
  if (quantity) return *quantity;
  fail(node, path, "found " + show(node) + ": " + quantity.error().message);
  return {};
}

double Reader::value(const Node& node, std::string_view path, Measure measure) {
  if (failed_) return 0;
  const MeasureInfo& info = measure_info(measure);
  const auto wanted = [&] {
    std::string what = info.article;
    if (info.sample[0] != 0) what += std::string(" such as ") + quote(info.sample);
    return what;
  };
  if (node.kind == NodeKind::number) return node.number;
  if (!node.is_text()) return expected(node, path, wanted()), 0;
  Quantity quantity;
  const bool computed = !node.text.empty() && (node.text[0] == '=' || node.text[0] == '$');
  if (computed) {
    quantity = evaluate(node, path, std::string_view(node.text).substr(1));
  } else {
    const core::Result<Quantity> parsed = parse_quantity(node.text);
    if (!parsed) return expected(node, path, wanted(), "; " + parsed.error().message), 0;
    quantity = *parsed;
  }
  if (failed_) return 0;
  const Dimension plain{};
  const bool planar_density =
      measure == Measure::density && dimension == 2 &&
      quantity.dimension == multiply_dimensions(measure_dimension(measure), measure_dimension(Measure::length));
  // A time may be written as the rate that it belongs to: "60 Hz" for 1/60 s.
  const bool rate_for_time =
      measure == Measure::time && quantity.dimension == measure_dimension(Measure::rate) && quantity.value > 0;
  if (rate_for_time) return 1 / quantity.value;
  // A number alone is in SI units, but an angle is nothing except an angle, nor a frequency an angular speed.
  const Dimension& due = measure_dimension(measure);
  const bool bare = quantity.dimension == plain && quantity.dimension.angle == 0;
  const bool per_time = due == measure_dimension(Measure::rate);
  const bool same = quantity.dimension == due && (computed || !per_time || quantity.dimension.angle == due.angle);
  if (!bare && !(same && (measure != Measure::plain || quantity.dimension.angle == 0)) && !planar_density)
    return expected(node, path, wanted(), " instead of " + describe_dimension(quantity.dimension)), 0;
  return quantity.value;
}

}  // namespace carom::scene::detail
