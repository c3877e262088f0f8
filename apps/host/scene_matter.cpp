#include "apps/host/scene_matter.h"

namespace carom::host {
namespace {
using math::Vec3f;

Vec3f place_of(math::Vec2d p) { return {float(p.x), float(p.y), 0}; }
Vec3f place_of(math::Vec3d p) { return Vec3f(p); }

/// From the liquid's own colour at rest to white where it is fast.
std::uint32_t foam(std::uint32_t color, float t) {
  std::uint32_t out = 0xff;
  for (int shift = 0; shift < 24; shift += 8) {
    const float c = float(color >> shift & 255u), white = shift == 0 ? 255.0f : 235.0f;
    out |= std::uint32_t(c + (white - c) * t) << (shift + 8);
  }
  return out;
}

}  // namespace

void MatterPicture::begin(StageBase& stage, const scene::Matter& matter) {
  const Declaration& d = stage.declaration();
  least_ = float(0.0015 * (d.dimension == 2 ? d.camera.height : math::distance(d.camera.position, d.camera.target)));
  const auto triangles = [](std::span<const std::uint32_t> t) {
    return std::vector<std::uint32_t>(t.begin(), t.end());
  };
  for (const auto& cloth : matter.cloths)
    cloths_.push_back(stage.add_surface(triangles(cloth.thing.triangles()), cloth.color << 8 | 0xff));
  for (const auto& body : matter.soft_bodies)
    soft_bodies_.push_back(stage.add_surface(triangles(body.thing.surface()), body.color << 8 | 0xff));
}

void MatterPicture::set_surfaces(StageBase& stage, const scene::Matter& matter) {
  const auto corners = [this](std::span<const math::Vec3d> positions) -> std::span<const Vec3f> {
    corners_.clear();
    for (const math::Vec3d& p : positions) corners_.push_back(Vec3f(p));
    return corners_;
  };
  for (std::size_t i = 0; i < cloths_.size(); ++i) {
    const particles::Cloth& cloth = matter.cloths[i].thing;
    if (cloth.torn())
      stage.set_surface(cloths_[i], corners(cloth.positions()),
                        std::vector<std::uint32_t>(cloth.triangles().begin(), cloth.triangles().end()));
    else
      stage.set_surface(cloths_[i], corners(cloth.positions()));
  }
  for (std::size_t i = 0; i < soft_bodies_.size(); ++i)
    stage.set_surface(soft_bodies_[i], corners(matter.soft_bodies[i].thing.positions()));
}

void MatterPicture::add_ropes(const scene::Matter& matter) {
  for (const auto& rope : matter.ropes) {
    const auto positions = matter.rope_set.positions(rope.thing);
    const auto broken = matter.rope_set.broken(rope.thing);
    const float radius = float(matter.rope_set.material(rope.thing).radius);
    const auto bead = [&](math::Vec3d p) {
      places_.push_back(Vec3f(p));
      radii_.push_back(math::max(radius, least_));
      colors_.push_back(rope.color << 8 | 0xff);
    };
    for (std::size_t i = 0; i + 1 < positions.size(); ++i) {
      if (broken[i]) continue;
      const double way = math::distance(positions[i], positions[i + 1]);
      const int pieces = math::clamp(int(way / (0.8 * double(math::max(radius, least_)))), 1, 24);
      for (int k = 0; k < pieces; ++k) bead(math::lerp(positions[i], positions[i + 1], double(k) / pieces));
    }
    bead(positions.back());
  }
}

template <class D>
void MatterPicture::add_balls(const scene::MatterOf<D>& many) {
  const auto ball = [this](Vec3f place, float radius, std::uint32_t rgba) {
    places_.push_back(place);
    radii_.push_back(radius);
    colors_.push_back(rgba);
  };
  for (const auto& liquid : many.liquids) {
    const particles::Fluid<D>& fluid = liquid.thing;
    const float radius = 0.62f * fluid.definition().spacing;
    for (int i = 0; i < fluid.size(); ++i) {
      // Tagged parts are tinted: half way to green.
      const std::uint32_t color = fluid.tag(i) == 0 ? liquid.color : (liquid.color & 0xfefefe) / 2 + 0x1c4d3a;
      ball(place_of(fluid.position(i)), radius, foam(color, math::min(math::length(fluid.velocity(i)) / 4, 1.0f)));
    }
  }
  for (const auto& entry : many.grains) {
    const particles::Granular<D>& grains = entry.thing;
    for (int i = 0; i < grains.size(); ++i)
      // Every fifth a little darker, so that one sees them turn over.
      ball(place_of(grains.position(i)), grains.radius(i),
           (i % 5 == 0 ? (entry.color & 0xfefefe) / 2 + (entry.color & 0xf8f8f8) / 8 * 3 : entry.color) << 8 | 0xff);
  }
  for (const auto& entry : many.particles) {
    entry.thing.system.look(found_, found_radii_, found_colors_);
    places_.insert(places_.end(), found_.begin(), found_.end());
    colors_.insert(colors_.end(), found_colors_.begin(), found_colors_.end());
    for (const float r : found_radii_) radii_.push_back(math::max(r, least_));
  }
}

template <class D>
void MatterPicture::draw(StageBase& stage, const scene::Matter& matter) {
  places_.clear();
  radii_.clear();
  colors_.clear();
  if constexpr (D::dimension == 3) {
    set_surfaces(stage, matter);
    add_ropes(matter);
  }
  add_balls(matter.of<D>());
  stage.points(places_, radii_, colors_);
}
template void MatterPicture::draw<rigid::Dim2>(StageBase&, const scene::Matter&);
template void MatterPicture::draw<rigid::Dim3>(StageBase&, const scene::Matter&);

}  // namespace carom::host
