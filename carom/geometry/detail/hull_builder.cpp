// Quickhull (Barber, Dobkin, Huhdanpaa 1996) that takes the farthest of all points first. Since the arithmetic is
// exact, the visible region is always a disc and its border one cycle: no case needs repair. A triangle in whose plane
// the new point lies counts as not visible, and none of the new triangles can then be degenerate: a point on the line
// of a border edge would lie in the plane of the visible triangle beside it.
#include "carom/geometry/detail/hull_builder.h"

#include <utility>

namespace carom::geometry::detail {

namespace {

namespace quickhull {

constexpr std::uint32_t none = 0xFFFFFFFF;

struct Face {
  HullTriangle triangle;
  GridPoint normal;
  double inverse_length = 0;
  bool alive = true;
  std::vector<std::uint32_t> outside;  // points strictly above
  std::uint32_t farthest = none;
  double height = 0;
};

class Builder {
 public:
  Builder(std::span<const GridPoint> points, double tolerance) : points_(points), tolerance_(tolerance) {
    face_from_.assign(points.size(), none);
  }

  HullFailure start();
  HullFailure grow(std::size_t limit, bool stop_at_limit);
  std::vector<HullTriangle> triangles() const;

 private:
  std::uint32_t add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  double height(const Face& face, std::uint32_t p) const;
  void assign(std::uint32_t p, std::uint32_t first_face);
  std::uint32_t highest_face() const;
  bool sweep();
  void insert(std::uint32_t face, std::uint32_t p);

  std::span<const GridPoint> points_;
  double tolerance_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> face_from_;  // of the border edge or new triangle that starts at a point
  std::size_t corners_ = 0;
};

std::uint32_t Builder::add_face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  Face face;
  face.triangle.corner = {a, b, c};
  face.normal = normal_of(points_[a], points_[b], points_[c]);
  face.inverse_length = 1 / math::length(to_vector(face.normal));
  faces_.push_back(std::move(face));
  return std::uint32_t(faces_.size() - 1);
}

double Builder::height(const Face& face, std::uint32_t p) const {
  return double(orient(face.normal, points_[face.triangle.corner[0]], points_[p])) * face.inverse_length;
}

// Gives p to the face, from first_face on, above which it stands highest; to none where it is above none.
void Builder::assign(std::uint32_t p, std::uint32_t first_face) {
  std::uint32_t best = none;
  double highest = 0;
  for (std::uint32_t f = first_face; f < faces_.size(); ++f) {
    if (!faces_[f].alive) continue;
    const double h = height(faces_[f], p);
    if (h > highest) highest = h, best = f;
  }
  if (best == none) return;
  Face& face = faces_[best];
  face.outside.push_back(p);
  if (highest > face.height || (highest == face.height && p < face.farthest)) face.height = highest, face.farthest = p;
}

HullFailure Builder::start() {
  const std::uint32_t n = std::uint32_t(points_.size());
  std::uint32_t a = 0;
  for (std::uint32_t i = 1; i < n; ++i) {
    const GridPoint &p = points_[i], &q = points_[a];
    if (p.x < q.x || (p.x == q.x && (p.y < q.y || (p.y == q.y && p.z < q.z)))) a = i;
  }
  const auto farthest = [n](auto&& measure) {
    std::pair<double, std::uint32_t> best{-1, 0};
    for (std::uint32_t i = 0; i < n; ++i) {
      const double value = measure(i);
      if (value > best.first) best = {value, i};
    }
    return best;
  };
  const math::Vec3d origin = to_vector(points_[a]);
  const auto [span, b] = farthest([&](std::uint32_t i) { return math::distance(to_vector(points_[i]), origin); });
  if (!(span > tolerance_)) return HullFailure::point;
  const auto [width, c] = farthest(
      [&, b = b](std::uint32_t i) { return math::length(to_vector(normal_of(points_[a], points_[b], points_[i]))); });
  if (!(width / span > 8 * tolerance_)) return HullFailure::line;
  const GridPoint normal = normal_of(points_[a], points_[b], points_[c]);
  const auto [volume, d] =
      farthest([&](std::uint32_t i) { return math::abs(double(orient(normal, points_[a], points_[i]))); });
  if (!(volume / width > 8 * tolerance_)) return HullFailure::plane;

  std::uint32_t p = b, q = c;
  if (orient(normal, points_[a], points_[d]) > 0) std::swap(p, q);  // d lies below the triangle a, p, q
  add_face(a, p, q);
  add_face(p, a, d);
  add_face(q, p, d);
  add_face(a, q, d);
  faces_[0].triangle.neighbor = {1, 2, 3};
  faces_[1].triangle.neighbor = {0, 3, 2};
  faces_[2].triangle.neighbor = {0, 1, 3};
  faces_[3].triangle.neighbor = {0, 2, 1};
  corners_ = 4;
  for (std::uint32_t i = 0; i < n; ++i) assign(i, 0);
  return HullFailure::none;
}

std::uint32_t Builder::highest_face() const {
  std::uint32_t best = none;
  double highest = tolerance_;
  for (std::uint32_t f = 0; f < faces_.size(); ++f)
    if (faces_[f].alive && faces_[f].height > highest) highest = faces_[f].height, best = f;
  return best;
}

// A point is kept with one face only, and may by now stand higher above another one. Asks all again; true where one of
// them is not within tolerance.
bool Builder::sweep() {
  for (Face& face : faces_) face.outside.clear(), face.farthest = none, face.height = 0;
  for (std::uint32_t i = 0; i < points_.size(); ++i) assign(i, 0);
  return highest_face() != none;
}

void Builder::insert(std::uint32_t start_face, std::uint32_t p) {
  std::vector<std::uint32_t> visible{start_face}, orphans;
  struct BorderEdge {
    std::uint32_t from, to, outer;
  };
  std::vector<BorderEdge> border;
  faces_[start_face].alive = false;
  for (std::size_t k = 0; k < visible.size(); ++k) {
    const Face& face = faces_[visible[k]];
    orphans.insert(orphans.end(), face.outside.begin(), face.outside.end());
    for (std::size_t e = 0; e < 3; ++e) {
      const std::uint32_t other = face.triangle.neighbor[e];
      if (!faces_[other].alive) continue;
      if (orient(faces_[other].normal, points_[faces_[other].triangle.corner[0]], points_[p]) > 0) {
        faces_[other].alive = false;
        visible.push_back(other);
      }
    }
  }
  for (const std::uint32_t v : visible)
    for (std::size_t e = 0; e < 3; ++e) {
      const HullTriangle& t = faces_[v].triangle;
      if (faces_[t.neighbor[e]].alive) border.push_back({t.corner[e], t.corner[(e + 1) % 3], t.neighbor[e]});
    }
  const std::uint32_t first_new = std::uint32_t(faces_.size());
  for (const BorderEdge& edge : border) {
    const std::uint32_t f = add_face(edge.from, edge.to, p);
    faces_[f].triangle.neighbor[0] = edge.outer;
    HullTriangle& outer = faces_[edge.outer].triangle;
    for (std::size_t e = 0; e < 3; ++e)
      if (outer.corner[e] == edge.to && outer.corner[(e + 1) % 3] == edge.from) outer.neighbor[e] = f;
    face_from_[edge.from] = f;
  }
  for (std::uint32_t f = first_new; f < faces_.size(); ++f) {
    const std::uint32_t next = face_from_[faces_[f].triangle.corner[1]];
    faces_[f].triangle.neighbor[1] = next;
    faces_[next].triangle.neighbor[2] = f;
  }
  for (const std::uint32_t q : orphans)
    if (q != p) assign(q, first_new);
  for (const std::uint32_t v : visible) faces_[v].outside = {};
  ++corners_;
}

HullFailure Builder::grow(std::size_t limit, bool stop_at_limit) {
  while (true) {
    const std::uint32_t f = highest_face();
    if (f == none) {
      if (!sweep()) return HullFailure::none;
      continue;
    }
    if (corners_ >= limit) return stop_at_limit ? HullFailure::none : HullFailure::too_many;
    insert(f, faces_[f].farthest);
  }
}

std::vector<HullTriangle> Builder::triangles() const {
  std::vector<std::uint32_t> place(faces_.size(), none);
  std::uint32_t count = 0;
  for (std::size_t f = 0; f < faces_.size(); ++f)
    if (faces_[f].alive) place[f] = count++;
  std::vector<HullTriangle> result;
  result.reserve(count);
  for (const Face& face : faces_) {
    if (!face.alive) continue;
    HullTriangle t = face.triangle;
    for (std::uint32_t& neighbor : t.neighbor) neighbor = place[neighbor];
    result.push_back(t);
  }
  return result;
}

}  // namespace quickhull

}  // namespace

TriangulatedHull triangulate_hull(std::span<const GridPoint> points, double tolerance, std::size_t limit,
                                  bool stop_at_limit) {
  TriangulatedHull result;
  if (points.empty()) {
    result.failure = HullFailure::point;
    return result;
  }
  quickhull::Builder builder(points, tolerance);
  result.failure = builder.start();
  if (result.failure == HullFailure::none) result.failure = builder.grow(limit, stop_at_limit);
  if (result.failure == HullFailure::none) result.triangles = builder.triangles();
  return result;
}

}  // namespace carom::geometry::detail
