// Reads the fields of a scene file by their tables. The first error is kept; after it every read gives its fallback,
// so that readers need no checks of their own between fields.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carom/math/transform.h"
#include "carom/scene/detail/document.h"
#include "carom/scene/detail/expression.h"
#include "carom/scene/detail/fields.h"
#include "carom/scene/scene.h"

namespace carom::scene::detail {

struct SceneDocument {
  std::vector<std::string> files;               ///< names, as errors show them
  std::vector<SourceFile> sources;              ///< texts as read, the scene itself first
  std::vector<Node> parts;                      ///< included files in order, the scene itself last
  std::vector<Dimension> parameter_dimensions;  ///< of Scene::parameters
  int maximum_objects = 200000;
  const Node& main() const { return parts.back(); }
};

/// An object of the file that has been checked against its table.
struct Object {
  const Node* node = nullptr;
  std::string path;
  const ObjectKind* kind = nullptr;

  const Node* find(std::string_view key) const { return node->find(key); }
  bool has(std::string_view key) const { return node->find(key) != nullptr; }
  std::string path_of(std::string_view key) const;
};

class Reader {
 public:
  explicit Reader(const SceneDocument& document) : document_(document) {}

  int dimension = 3;
  double step = 1.0 / 60;  ///< s, the scene's
  struct Variable {
    std::string name;
    double value = 0;
    Dimension dimension{};
  };
  std::vector<Variable> variables;  ///< what expressions may name; the last of a name counts

  bool failed() const { return failed_; }
  core::Error error() const { return core::Error{error_}; }
  void fail(const Node& at, std::string_view path, std::string_view message);
  /// "found X, expected Y".
  void expected(const Node& at, std::string_view path, std::string_view what, std::string_view hint = {});
  /// Passes an error of the engine on, with the place in the file.
  bool accept(const core::Status& status, const Node& at, std::string_view path);

  /// Checks that the node is an object with known keys, none missing.
  bool open(const Node& node, std::string path, const ObjectKind& kind, Object& out);

  double number(const Object& o, std::string_view key, double fallback);
  double number(const Object& o, std::string_view key, double fallback, Measure measure);
  int integer(const Object& o, std::string_view key, int fallback, int low, int high);
  std::uint32_t user_id(const Object& o);  ///< of a material, under that key: any 32 bits, 0 where absent
  bool flag(const Object& o, std::string_view key, bool fallback);
  /// With {expressions} in braces replaced by their values.
  std::string text(const Object& o, std::string_view key, std::string_view fallback = {});
  /// The index of the choice, or the fallback where the key is absent.
  int choice(const Object& o, std::string_view key, int fallback);
  std::uint64_t bits(const Object& o, std::string_view key, std::uint64_t fallback);
  std::optional<std::uint32_t> color(const Object& o, std::string_view key);
  /// Two components in the plane, three in space.
  math::Vec3d vector(const Object& o, std::string_view key, math::Vec3d fallback = {});
  /// As a vector; a single number in the plane, which goes to z.
  math::Vec3d angular(const Object& o, std::string_view key);
  math::Quatf rotation3(const Object& o, std::string_view key);
  math::Rot2f rotation2(const Object& o, std::string_view key);
  std::vector<math::Vec3d> points(const Object& o, std::string_view key);
  std::vector<std::vector<math::Vec3d>> point_lists(const Object& o, std::string_view key);
  std::vector<double> numbers(const Object& o, std::string_view key, int count = -1);
  /// False where the key "if" is there and zero.
  bool wanted(const Object& o);

  double value(const Node& node, std::string_view path, Measure measure);
  /// The value with whatever dimension it has.
  Quantity any_value(const Node& node, std::string_view path);
  std::string expand(const Node& node, std::string_view path, std::string_view text);

 private:
  const Field& field(const Object& o, std::string_view key) const;
  Quantity evaluate(const Node& node, std::string_view path, std::string_view text);
  math::Vec3d vector_of(const Node& node, std::string_view path, Measure measure);
  std::vector<math::Vec3d> points_of(const Node& list, const std::string& path, Measure measure);

  const SceneDocument& document_;
  bool failed_ = false;
  std::string error_;
};

std::string index_path(std::string_view path, std::size_t index);

}  // namespace carom::scene::detail
