#include "apps/host/scene_destruction.h"

namespace carom::host {
namespace {
using math::Vec3d;

/// A circle about an axis k: lines square to it.
void ring(StageBase& stage, Vec3d center, double radius, int axis, std::uint32_t rgba) {
  constexpr int sides = 64;
  const auto at = [&](int i) {
    const math::SinCos<double> t = math::sincos(2 * math::pi * i / sides);
    Vec3d p = center;
    p[(axis + 1) % 3] += radius * t.cos;
    p[(axis + 2) % 3] += radius * t.sin;
    return p;
  };
  for (int i = 0; i < sides; ++i) stage.line(at(i), at(i + 1), rgba);
}

}  // namespace

template <class D>
void DestructionPicture::draw_guns(Stage<D>& stage, const scene::DestructionOf<D>& all, double now) {
  const Declaration& d = stage.declaration();
  const double seen = D::dimension == 2 ? d.camera.height : math::distance(d.camera.position, d.camera.target);
  for (const auto& entry : all.guns) {
    const ballistics::ProjectileBatch& batch = entry.thing.batch;
    const std::uint32_t color = entry.color << 8;
    places_.clear();
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Vec3d at = batch.at(i).position;
      places_.push_back(math::Vec3f(at));
      stage.line(batch.previous_position(i), at, color | 0xb0);
    }
    const float radius = float(math::max(0.5 * entry.thing.definition.weapon.ammunition.diameter, 0.002 * seen));
    stage.points(places_, radius, color | 0xff);
    for (const ballistics::BatchHit& hit : entry.thing.last) {
      const auto struck = stage.world().state(hit.body);
      marks_.push_back({hit.point, now, struck.ok() && struck->type == rigid::BodyType::fixed});
      // Their way within the step ends where they hit.
      stage.line(hit.point - hit.velocity * math::min(hit.time, 0.02), hit.point, color | 0xb0);
    }
  }
  draw_marks(stage, seen, now);
}

void DestructionPicture::draw_marks(StageBase& stage, double seen, double now) {
  if (marks_.size() > 400) marks_.erase(marks_.begin(), marks_.end() - 400);
  for (const bool fresh : {false, true}) {
    places_.clear();
    for (const Mark& mark : marks_)
      if (fresh ? now - mark.time < 0.5 : mark.stays) places_.push_back(math::Vec3f(mark.place));
    if (!places_.empty()) stage.points(places_, float((fresh ? 0.004 : 0.003) * seen), fresh ? 0xffe9a8ff : 0x181410ff);
  }
}

template <class D>
void DestructionPicture::draw_fronts(Stage<D>& stage, const scene::DestructionOf<D>& all, double now) {
  for (const auto& entry : all.explosions) {
    const blast::Explosion<D>& e = entry.thing.explosion;
    if (entry.thing.casing && entry.thing.casing->batch().size() > 0) {
      const ballistics::ProjectileBatch& batch = entry.thing.casing->batch();
      places_.clear();
      for (std::size_t i = 0; i < batch.size(); ++i) {
        places_.push_back(math::Vec3f(batch.at(i).position));
        stage.line(batch.previous_position(i), batch.at(i).position, 0xffb04060);
      }
      stage.points(places_, 0.02f, 0xffd080ff);
    }
    const Vec3d center = in_space(e.charge().position);
    if (now < e.charge().time) {
      const float radius = float(0.06 * math::pow(e.charge().mass, 1 / 3.0));
      places_.assign(1, math::Vec3f(center));
      stage.points(places_, radius, 0xd04a2aff);
      continue;
    }
    const double radius = e.front_radius(now);
    if (e.finished(now) || !(radius > 0)) continue;
    ring(stage, center, radius, D::dimension == 2 ? 2 : 1, 0xf08030ff);
    if (D::dimension == 3)
      for (const int axis : {0, 2}) ring(stage, center, radius, axis, 0xf0803070);
  }
}

template <class D>
void DestructionPicture::show_pieces(Stage<D>& stage, const scene::SceneWorld& world) {
  // The pieces of all by their colours, before the rest is taken up that nobody named.
  for (const auto& entry : world.destruction->of<D>().structures) {
    const blast::Structure<D>& structure = entry.thing;
    const scene::SceneBody* whole = world.find_body(entry.name);
    const std::uint32_t color = whole != nullptr && whole->colored ? whole->color : 0;
    for (const rigid::BodyId body : structure.made())
      if (stage.world().contains(body)) stage.adopt(body, color);
  }
  for (const auto& entry : world.destruction->of<D>().structures) {
    const blast::Structure<D>& structure = entry.thing;
    if (structure.made().empty() && structure.changed().empty()) continue;
    stage.adopt_all();
    for (const rigid::BodyId body : structure.changed())
      if (stage.world().contains(body)) stage.redraw(body);
  }
  for (const auto& entry : world.destruction->of<D>().rockets) {
    if (!entry.thing.just_dropped()) continue;
    const scene::SceneBody* whole = world.find_body(entry.name);
    const rigid::BodyId part = entry.thing.dropped().back();
    if (stage.world().contains(part)) stage.adopt(part, whole != nullptr && whole->colored ? whole->color : 0);
    stage.adopt_all();
    if (stage.world().contains(entry.thing.body())) stage.redraw(entry.thing.body());
  }
}

template <class D>
void DestructionPicture::draw(Stage<D>& stage, const scene::SceneWorld& world) {
  const double now = world.time();
  show_pieces(stage, world);
  draw_guns(stage, world.destruction->of<D>(), now);
  draw_fronts(stage, world.destruction->of<D>(), now);
}
template void DestructionPicture::draw(Stage<rigid::Dim2>&, const scene::SceneWorld&);
template void DestructionPicture::draw(Stage<rigid::Dim3>&, const scene::SceneWorld&);

}  // namespace carom::host
