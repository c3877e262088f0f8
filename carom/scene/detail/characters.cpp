#include "carom/scene/detail/characters.h"

#include "carom/scene/detail/joints.h"

namespace carom::scene::detail {
namespace {

/// What both kinds have.
template <class D, class Definition>
void read_common(Reader& reader, const Object& o, Definition& d) {
  d.radius = float(reader.number(o, "radius", double(d.radius)));
  d.half_length = float(reader.number(o, "half_length", double(d.half_length)));
  if (o.has("up")) d.up = vector_for(reader.vector(o, "up"), static_cast<D*>(nullptr));
  d.max_slope = float(reader.number(o, "max_slope", double(d.max_slope)));
  d.step_height = float(reader.number(o, "step_height", double(d.step_height)));
  d.mass = float(reader.number(o, "mass", double(d.mass)));
  read_filter(reader, o, d.filter);
}

template <class Character, class D, class Definition>
bool make(Reader& reader, const Object& o, rigid::World<D>& world, const Definition& definition, SceneCharacter& out) {
  const auto feet = position_of(reader.vector(o, "position"), static_cast<D*>(nullptr));
  if (reader.failed()) return false;
  core::Result<Character> made = Character::create(world, definition, feet);
  if (!made.ok()) return reader.accept(made.error(), *o.node, o.path);
  out.body = made->body();
  out.walker = std::move(made).value();
  return true;
}

/// A key that only the other kind has.
bool refuse(Reader& reader, const Object& o, const char* key, const char* kind) {
  if (!o.has(key)) return true;
  reader.fail(*o.find(key), o.path_of(key), std::string("found a key that only a ") + kind + " character has");
  return false;
}

}  // namespace

template <class D>
bool read_character(Reader& reader, const Object& o, rigid::World<D>& world, SceneCharacter& out) {
  const bool dynamic = reader.choice(o, "type", 1) == 1;
  if (reader.failed()) return false;
  if (dynamic) {
    rigid::DynamicCharacterDef<D> d;
    read_common<D>(reader, o, d);
    d.leg_force = float(reader.number(o, "leg_force", double(d.leg_force)));
    d.air_force = float(reader.number(o, "air_force", double(d.air_force)));
    return refuse(reader, o, "push_force", "kinematic") && make<rigid::DynamicCharacter<D>>(reader, o, world, d, out);
  }
  rigid::CharacterDef<D> d;
  read_common<D>(reader, o, d);
  d.push_force = float(reader.number(o, "push_force", double(d.push_force)));
  return refuse(reader, o, "leg_force", "dynamic") && refuse(reader, o, "air_force", "dynamic") &&
         make<rigid::Character<D>>(reader, o, world, d, out);
}

template bool read_character<rigid::Dim2>(Reader&, const Object&, rigid::World2&, SceneCharacter&);
template bool read_character<rigid::Dim3>(Reader&, const Object&, rigid::World3&, SceneCharacter&);

}  // namespace carom::scene::detail
