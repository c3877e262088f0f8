// What the demos of liquids and grains share.
#pragma once

#include <optional>
#include <vector>

#include "apps/host/demos/demos.h"
#include "carom/particles/fluid.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_fluid_tank();
std::unique_ptr<Demo> make_dam_break();
std::unique_ptr<Demo> make_water_fountain();
std::unique_ptr<Demo> make_sand_pile();

/// A liquid as balls, from deep blue at rest to white at `fast` m/s; tagged ones are tinted.
template <class D>
class LiquidLook {
 public:
  void draw(StageBase& stage, const particles::Fluid<D>& fluid, float fast) {
    const int n = fluid.size();
    places_.resize(n);
    radii_.assign(n, 0.62f * fluid.definition().spacing);
    colors_.resize(n);
    for (int i = 0; i < n; ++i) {
      const auto p = fluid.position(i);
      if constexpr (D::dimension == 2)
        places_[i] = {float(p.x), float(p.y), 0};
      else
        places_[i] = Vec3f(p);
      const float t = math::min(math::length(fluid.velocity(i)) / fast, 1.0f);
      const auto mix = [&](float a, float b) { return std::uint32_t(a + (b - a) * t); };
      const bool tinted = fluid.tag(i) != 0;
      colors_[i] = mix(tinted ? 47.f : 38.f, 225.f) << 24 | mix(tinted ? 156.f : 98.f, 240.f) << 16 |
                   mix(tinted ? 149.f : 190.f, 255.f) << 8 | 0xffu;
    }
    stage.points(places_, radii_, colors_);
  }

 private:
  std::vector<Vec3f> places_;
  std::vector<float> radii_;
  std::vector<std::uint32_t> colors_;
};

}  // namespace carom::host::demo
