// Volume, first and second moments of a closed surface of triangles, by tetrahedra about an origin near it.
#pragma once

#include "carom/geometry/mass_properties.h"
#include "carom/math/simd_double.h"

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

/// The same of convex polygons, two triangles of a fan at a time. What nobody asks for is not computed.
class FanSum {
 public:
  explicit FanSum(math::Vec3d origin) : origin_(origin) {}
  /// A polygon of `count` corners, counterclockwise seen from outside; corner(k): the k-th.
  template <class Corner>
  void add(std::size_t count, Corner&& corner) {
    const math::Vec3d o = corner(0) - origin_;
    const Triple a = Triple::of(o, o);
    for (std::size_t k = 1; k + 1 < count; k += 2) {
      // A triangle too many has two corners in one place, and no volume at all.
      const math::Vec3d p = corner(k) - origin_, q = corner(k + 1) - origin_,
                        r = corner(k + 2 < count ? k + 2 : k + 1) - origin_;
      add_pair(a, Triple::of(p, q), Triple::of(q, r));
    }
  }
  double volume() const { return both(six_) / 6; }
  math::Vec3d center() const {
    const double four_volumes = 4 * both(six_);
    return origin_ + math::Vec3d{both(first_.x), both(first_.y), both(first_.z)} / four_volumes;
  }
  geometry::MassProperties3 properties(double density) const {
    geometry::MassProperties3 m;
    const double v = volume();
    if (!(v > 0)) return m;
    m.mass = density * v;
    m.center = center();
    const math::Vec3d c = m.center - origin_;
    const double xx = both(xx_) / 120 - v * c.x * c.x, yy = both(yy_) / 120 - v * c.y * c.y,
                 zz = both(zz_) / 120 - v * c.z * c.z;
    const double xy = -density * (both(xy_) / 120 - v * c.x * c.y), xz = -density * (both(xz_) / 120 - v * c.x * c.z),
                 yz = -density * (both(yz_) / 120 - v * c.y * c.z);
    m.inertia = {{density * (yy + zz), xy, xz}, {xy, density * (xx + zz), yz}, {xz, yz, density * (xx + yy)}};
    return m;
  }

 private:
  using Pair = math::WideDouble<2>;
  struct Triple {
    Pair x, y, z;
    static Triple of(math::Vec3d p, math::Vec3d q) {
      return {{Pair::Vector{p.x, q.x}}, {Pair::Vector{p.y, q.y}}, {Pair::Vector{p.z, q.z}}};
    }
  };
  static double both(Pair p) { return p.v[0] + p.v[1]; }
  void add_pair(const Triple& a, const Triple& b, const Triple& c) {
    const Pair w = a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
    const Pair x = a.x + b.x + c.x, y = a.y + b.y + c.y, z = a.z + b.z + c.z;
    six_ = six_ + w;
    first_ = {first_.x + w * x, first_.y + w * y, first_.z + w * z};
    xx_ = xx_ + w * (a.x * a.x + b.x * b.x + c.x * c.x + x * x);
    yy_ = yy_ + w * (a.y * a.y + b.y * b.y + c.y * c.y + y * y);
    zz_ = zz_ + w * (a.z * a.z + b.z * b.z + c.z * c.z + z * z);
    xy_ = xy_ + w * (a.x * a.y + b.x * b.y + c.x * c.y + x * y);
    xz_ = xz_ + w * (a.x * a.z + b.x * b.z + c.x * c.z + x * z);
    yz_ = yz_ + w * (a.y * a.z + b.y * b.z + c.y * c.z + y * z);
  }
  math::Vec3d origin_;
  Pair six_{}, xx_{}, yy_{}, zz_{}, xy_{}, xz_{}, yz_{};  // of six times the volume, 120 times the second moments
  Triple first_{};
};

}  // namespace carom::blast::detail
