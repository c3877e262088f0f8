// Volume, first and second moments of a closed surface of triangles, by tetrahedra about an origin near it.
#pragma once

#include "carom/geometry/mass_properties.h"

namespace carom::blast::detail {

class SolidSum {
 public:
  explicit SolidSum(math::Vec3d origin) : origin_(origin) {}
  /// Counterclockwise seen from outside. ∫x xᵀ dV = V/20 (Σ pᵢpᵢᵀ + (Σpᵢ)(Σpᵢ)ᵀ).
  void add(math::Vec3d a, math::Vec3d b, math::Vec3d c) {
    a -= origin_, b -= origin_, c -= origin_;
    const double v = triple(a, b, c) / 6;
    const math::Vec3d s = a + b + c;
    volume_ += v;
    first_ += (v / 4) * s;
    const double w = v / 20;
    xx_ += w * (a.x * a.x + b.x * b.x + c.x * c.x + s.x * s.x);
    yy_ += w * (a.y * a.y + b.y * b.y + c.y * c.y + s.y * s.y);
    zz_ += w * (a.z * a.z + b.z * b.z + c.z * c.z + s.z * s.z);
    xy_ += w * (a.x * a.y + b.x * b.y + c.x * c.y + s.x * s.y);
    xz_ += w * (a.x * a.z + b.x * b.z + c.x * c.z + s.x * s.z);
    yz_ += w * (a.y * a.z + b.y * b.z + c.y * c.z + s.y * s.z);
  }
  double volume() const { return volume_; }
  geometry::MassProperties3 properties(double density) const {
    geometry::MassProperties3 m;
    if (!(volume_ > 0)) return m;
    const math::Vec3d c = first_ / volume_;
    m.mass = density * volume_;
    m.center = origin_ + c;
    const double xx = xx_ - volume_ * c.x * c.x, yy = yy_ - volume_ * c.y * c.y, zz = zz_ - volume_ * c.z * c.z;
    const double xy = -density * (xy_ - volume_ * c.x * c.y), xz = -density * (xz_ - volume_ * c.x * c.z),
                 yz = -density * (yz_ - volume_ * c.y * c.z);
    m.inertia = {{density * (yy + zz), xy, xz}, {xy, density * (xx + zz), yz}, {xz, yz, density * (xx + yy)}};
    return m;
  }

 private:
  math::Vec3d origin_, first_{};
  double volume_ = 0, xx_ = 0, yy_ = 0, zz_ = 0, xy_ = 0, xz_ = 0, yz_ = 0;
};

}  // namespace carom::blast::detail
