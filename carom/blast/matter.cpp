#include "carom/blast/matter.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using core::Result;
using core::Status;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

namespace {

/// A step in the time of a charge.
template <class D>
struct Span {
  const Explosion<D>& explosion;
  double from, to, front;  // s after the detonation; m

  Span(const Explosion<D>& e, double now, double dt)
      : explosion(e), from(now - e.charge().time), to(from + dt), front(e.front_radius(now + dt)) {}

  /// Whether the wave is anywhere between two distances (m).
  bool meets(double nearest, double farthest) const {
    if (!(to > 0) || nearest > front || nearest > explosion.reach()) return false;
    const auto& charge = explosion.charge();  // the ground's wave comes later
    const double more = charge.burst == Burst::air ? 2 * (charge.position.y - charge.ground) : 0;
    const Wave last = explosion.wave_at(farthest + more);
    return from < last.arrival + 2.5 * last.duration;
  }
  /// The wind (m/s) of a wave as it is on the mean of the step's part in which it blows.
  double wind(const Wave& w) const {
    const double begins = math::max(from, w.arrival), ends = math::min(to, w.arrival + w.duration);
    if (!(ends > begins)) return 0;
    const SurfaceLoad side(w, 0);
    return wind_speed(math::max(0.0, (side.impulse(ends) - side.impulse(begins)) / (ends - begins)));
  }
};

Status check_step(double dt) {
  if (dt > 0 && math::is_finite(dt)) return {};
  return core::Error{core::refused("blast::push: dt", dt, "s > 0")};
}

/// The nearest and the farthest of points from a place.
struct Distances {
  double nearest = 1e300, farthest = 0;
  template <class P>
  void add(const P& point, const P& place) {
    const double r = distance(point, place);
    nearest = math::min(nearest, r), farthest = math::max(farthest, r);
  }
};

struct Face {
  std::uint32_t corner[3];
  Vec3d center, normal;  // a unit vector
  double area;
};
/// Faces that the wave may be at in the step, and half of the middle one of the sizes of what they bound.
double faces_near(const Span<Dim3>& span, std::span<const Vec3d> points, std::span<const std::uint32_t> corners,
                  std::vector<Face>& out) {
  const Vec3d charge = span.explosion.charge().position;
  Distances all;
  Vec3d low{1e300, 1e300, 1e300}, high = -low;
  for (const Vec3d& p : points) all.add(p, charge), low = math::min(low, p), high = math::max(high, p);
  if (!span.meets(all.nearest, all.farthest)) return 0;
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    Face f{{corners[t], corners[t + 1], corners[t + 2]}, {}, {}, 0};
    const Vec3d a = points[f.corner[0]], b = points[f.corner[1]], c = points[f.corner[2]];
    const Vec3d twice = cross(b - a, c - a);
    f.area = 0.5 * length(twice);
    f.center = (a + b + c) / 3.0;
    const double far = distance(charge, f.center);
    if (!(f.area > 0) || !(far > 0) || !span.meets(far, far)) continue;
    f.normal = twice / (2 * f.area);
    out.push_back(f);
  }
  const Vec3d half = 0.5 * (high - low);
  return half.x + half.y + half.z - math::max(half.x, math::max(half.y, half.z)) -
         math::min(half.x, math::min(half.y, half.z));
}
template <class Thing>
Status shares_of(const Explosion3& explosion, const rigid::World3& world, const std::vector<Thing>& things,
                 std::vector<double>& shares) {
  std::vector<Vec3d> places;
  for (const Thing& thing : things) places.push_back(thing.center);
  return explosion.shares_at(world, places, shares);
}

/// A wave on a face of a thing.
struct FaceLoad {
  const Face& face;
  const Wave& wave;
  double cosine;  // of the face's normal to where the wave comes from
  double clearing, share;
  /// N·s/m², of a side turned toward it by a cosine, within the step.
  double on(const Span<Dim3>& span, double toward) const {
    const SurfaceLoad load(wave, toward, clearing, share);
    return load.impulse(span.to) - load.impulse(span.from);
  }
};
/// `impulse_of`: what the thing takes of a FaceLoad, N·s.
template <class Thing, class ImpulseOf>
Result<Vec3d> push_faces(const Span<Dim3>& span, rigid::World3& world, Thing& thing,
                         std::span<const std::uint32_t> corners, const ImpulseOf& impulse_of) {
  std::vector<Face> faces;
  const double across = faces_near(span, thing.positions(), corners, faces);
  if (faces.empty()) return Vec3d{};
  std::vector<double> shares;
  if (Status s = shares_of(span.explosion, world, faces, shares); !s) return s.error();
  const double clearing = span.explosion.charge().clearing ? across : 0;
  Vec3d given{};
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const Face& f = faces[i];
    const WavesAt<Dim3> waves = span.explosion.waves_at(f.center);
    for (int k = 0; k < waves.count; ++k) {
      const Vec3d impulse = impulse_of(FaceLoad{f, waves.wave[k], dot(f.normal, waves.toward[k]), clearing, shares[i]});
      if (impulse == Vec3d{}) continue;
      for (const std::uint32_t c : f.corner)
        if (Status s = thing.add_impulse(int(c), impulse / 3.0, world); !s) return s.error();
      given += impulse;
    }
  }
  return given;
}

}  // namespace

Result<Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt, particles::Cloth& cloth) {
  if (Status s = check_step(dt); !s) return s.error();
  const Span<Dim3> span(explosion, world.time(), dt);
  const double mass_per_area = cloth.mass() / cloth.area();
  return push_faces(span, world, cloth, cloth.triangles(), [&](const FaceLoad& load) {
    const double cosine = math::abs(load.cosine);
    const Vec3d away = load.cosine > 0 ? -load.face.normal : load.face.normal;
    double speed = 0;
    for (const std::uint32_t c : load.face.corner) speed += dot(Vec3d(cloth.velocities()[c]), away) / 3;
    const double taken = sheet_impulse(load.on(span, cosine) - load.on(span, -cosine), mass_per_area, speed,
                                       cosine * span.wind(load.wave));
    return math::max(0.0, load.face.area * taken) * away;
  });
}

Result<Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt, particles::SoftBody& body) {
  if (Status s = check_step(dt); !s) return s.error();
  const Span<Dim3> span(explosion, world.time(), dt);
  return push_faces(span, world, body, body.surface(), [&](const FaceLoad& load) {
    return -load.face.area * load.on(span, load.cosine) * load.face.normal;
  });
}

Result<Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt, particles::RopeSet& ropes) {
  if (Status s = check_step(dt); !s) return s.error();
  const Span<Dim3> span(explosion, world.time(), dt);
  struct Piece {
    int rope, node;  // from this node to the next
    Vec3d center;
  };
  std::vector<Piece> pieces;
  for (int r = 0; r < ropes.size(); ++r) {
    const auto places = ropes.positions(r);
    for (std::size_t i = 0; i + 1 < places.size(); ++i) {
      const Vec3d center = 0.5 * (places[i] + places[i + 1]);
      const double far = distance(center, explosion.charge().position);
      if (far > 1e-6 && span.meets(far, far) && !ropes.broken(r)[i]) pieces.push_back({r, int(i), center});
    }
  }
  if (pieces.empty()) return Vec3d{};
  std::vector<double> shares;
  if (Status s = shares_of(explosion, world, pieces, shares); !s) return s.error();
  Vec3d given{};
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    const Piece& piece = pieces[k];
    const std::size_t i = std::size_t(piece.node);
    const Vec3d along = ropes.positions(piece.rope)[i + 1] - ropes.positions(piece.rope)[i];
    const double long_ = length(along);
    if (!(long_ > 0)) continue;
    const particles::RopeMaterial& material = ropes.material(piece.rope);
    const double mass = 0.5 * (ropes.mass(piece.rope, piece.node) + ropes.mass(piece.rope, piece.node + 1));
    const WavesAt<Dim3> waves = explosion.waves_at(piece.center);
    for (int w = 0; w < waves.count; ++w) {
      // Across the rope alone: what blows along it hardly pulls.
      const Vec3d out = -waves.toward[w], across = out - (dot(out, along) / (long_ * long_)) * along;
      const double sine = length(across);
      if (!(sine > 1e-9)) continue;
      Wave wave = waves.wave[w];
      wave.pressure *= shares[k];
      const double load = material.drag_coefficient * 2 * material.radius * long_ * sine * sine *
                          (wind_impulse(wave, span.to) - wind_impulse(wave, span.from));
      const Vec3d push = across / sine;
      const double speed = 0.5 * dot(ropes.velocities(piece.rope)[i] + ropes.velocities(piece.rope)[i + 1], push);
      const Vec3d impulse = drag_impulse(load, mass, speed, sine * span.wind(wave)) * push;
      for (const int node : {piece.node, piece.node + 1})
        if (Status s = ropes.add_impulse(piece.rope, node, 0.5 * impulse, world); !s) return s.error();
      given += impulse;
    }
  }
  return given;
}

namespace {

/// A column of rays from the charge, a grain wide in the middle of all, and the first that it meets.
struct Column {
  std::int64_t key[3] = {0, 0, 0};  // which side of a cube about the charge, and where on it
  double distance = 0, area = 0;    // m; m² square to the ray there
  int index = 0;
  friend bool operator<(const Column& a, const Column& b) {
    for (int k = 0; k < 3; ++k)
      if (a.key[k] != b.key[k]) return a.key[k] < b.key[k];
    return a.distance != b.distance ? a.distance < b.distance : a.index < b.index;
  }
  bool same(const Column& b) const { return key[0] == b.key[0] && key[1] == b.key[1] && key[2] == b.key[2]; }
};
/// Projected on a cube about the charge, in cells `width` wide at unit distance.
template <class D>
Column column_of(const typename D::Position& way, double width, int index) {
  Column c;
  c.index = index;
  c.distance = length(way);
  int axis = 0;
  for (int k = 1; k < D::dimension; ++k)
    if (math::abs(way[k]) > math::abs(way[axis])) axis = k;
  c.key[0] = 2 * axis + (way[axis] < 0 ? 1 : 0);
  double slope = 1;
  for (int k = 1; k < D::dimension; ++k) {
    const double at = way[(axis + k) % D::dimension] / math::abs(way[axis]);
    c.key[k] = std::int64_t(math::floor(at / width));
    slope += at * at;
  }
  // A cell of the cube's side, seen from the charge.
  if constexpr (D::dimension == 2)
    c.area = c.distance * width / slope;
  else
    c.area = math::square(c.distance * width) / (slope * math::sqrt(slope));
  return c;
}

/// Whether a wall of the domain stands between the charge and a place in it.
template <class D, class Def>
bool walled(const Def& d, const typename D::Position& charge, const typename D::Position& place) {
  for (int k = 0; k < D::dimension; ++k) {
    const bool below = charge[k]<d.lower[k], above = charge[k]> d.upper[k];
    if ((!below && !above) || !d.walls[2 * k + (above ? 1 : 0)]) continue;
    if (k == 1) {
      if (below) return true;
      continue;  // the lid is open
    }
    if (charge[1] <= d.upper[1]) return true;
    // Where the way comes over the edge of the tank.
    const double t = (d.upper[1] - charge[1]) / (place[1] - charge[1]), at = charge[k] + t * (place[k] - charge[k]);
    if (below ? at < d.lower[k] : at > d.upper[k]) return true;
  }
  return false;
}

/// `many`: what has positions and velocities by index; mass_of(index) in kg.
template <class D, class Many, class Def, class MassOf>
Result<typename D::Position> push_many(const Explosion<D>& explosion, const rigid::World<D>& world, double dt,
                                       Many& many, const Def& domain, double width, const MassOf& mass_of) {
  using Position = typename D::Position;
  if (Status s = check_step(dt); !s) return s.error();
  const Span<D> span(explosion, world.time(), dt);
  const Position charge = explosion.charge().position;
  Distances all;
  Position low{}, high{};
  for (int i = 0; i < many.size(); ++i) {
    const Position p = many.position(i);
    all.add(p, charge);
    low = i == 0 ? p : math::min(low, p), high = i == 0 ? p : math::max(high, p);
  }
  if (many.size() == 0 || !span.meets(all.nearest, all.farthest)) return Position{};
  const double at_one = width / math::sqrt(math::max(all.nearest, width) * all.farthest);
  std::vector<Column> columns;
  for (int i = 0; i < many.size(); ++i)
    if (const Position way = many.position(i) - charge; length(way) > 1e-6)
      columns.push_back(column_of<D>(way, at_one, i));
  std::sort(columns.begin(), columns.end());
  std::vector<Column> first;
  std::vector<Position> places;
  for (const Column& c : columns) {
    if (!first.empty() && first.back().same(c)) continue;
    first.push_back(c);
    places.push_back(many.position(c.index));
  }
  std::vector<double> shares;
  if (Status s = explosion.shares_at(world, places, shares); !s) return s.error();
  double clearing = 1e300;
  for (int k = 0; k < D::dimension; ++k) clearing = math::min(clearing, 0.5 * (high[k] - low[k]) + 0.5 * width);
  Position given{};
  for (std::size_t k = 0; k < first.size(); ++k) {
    const Column& c = first[k];
    // Behind an obstacle both sides of it feel the same pressure.
    if (shares[k] < 1 || !span.meets(c.distance, c.distance) || walled<D>(domain, charge, places[k])) continue;
    const double mass = mass_of(c.index);
    const WavesAt<D> waves = explosion.waves_at(places[k]);
    for (int w = 0; w < waves.count; ++w) {
      const Wave& wave = waves.wave[w];
      const SurfaceLoad front(wave, 1, explosion.charge().clearing ? clearing : 0), back(wave, -1);
      const double load =
          front.impulse(span.to) - front.impulse(span.from) - back.impulse(span.to) + back.impulse(span.from);
      const Position out = -waves.toward[w], velocity(many.velocity(c.index));
      const double taken = sheet_impulse(c.area * load, mass, dot(velocity, out), span.wind(wave));
      if (!(taken > 0)) continue;
      if (Status s = many.set_velocity(c.index, typename D::Vector(velocity + (taken / mass) * out)); !s)
        return s.error();
      given += taken * out;
    }
  }
  return given;
}

}  // namespace

template <class D>
Result<typename D::Position> push(const Explosion<D>& explosion, const rigid::World<D>& world, double dt,
                                  particles::Fluid<D>& liquid) {
  const auto& d = liquid.definition();
  return push_many(explosion, world, dt, liquid, d, double(d.spacing),
                   [&](int) { return double(liquid.particle_mass()); });
}
template <class D>
Result<typename D::Position> push(const Explosion<D>& explosion, const rigid::World<D>& world, double dt,
                                  particles::Granular<D>& grains) {
  const auto& d = grains.definition();
  return push_many(explosion, world, dt, grains, d, 2 * double(d.radius), [&](int i) {
    const double r = double(grains.radius(i));
    return double(d.density) * math::pi * r * r * (D::dimension == 2 ? 1 : 4 * r / 3);
  });
}

template Result<math::Vec2d> push(const Explosion2&, const rigid::World2&, double, particles::Fluid2&);
template Result<math::Vec3d> push(const Explosion3&, const rigid::World3&, double, particles::Fluid3&);
template Result<math::Vec2d> push(const Explosion2&, const rigid::World2&, double, particles::Granular2&);
template Result<math::Vec3d> push(const Explosion3&, const rigid::World3&, double, particles::Granular3&);

}  // namespace carom::blast
