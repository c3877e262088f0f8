// The volume integrals of a convex polyhedron swept by a sphere, exactly: Steiner's decomposition into the polyhedron,
// a prism on every face, a circular wedge on every edge and a piece of a ball at every corner.
#include "carom/geometry/detail/mass_hull.h"

#include "carom/math/elementary.h"

namespace carom::geometry::detail {

namespace {

namespace hull_mass {

struct Context {
  const Hull& hull;
  Vec3d origin;
  double radius;
  std::vector<Vec3d> normals;  // of the faces, in double: the hull's own are rounded to float

  Vec3d vertex(std::uint16_t edge) const { return Vec3d(hull.vertices[hull.edges[edge].origin]) - origin; }
};

// Twice the area times the normal, as the sum over the fan: right for faces that are planar only to rounding.
Vec3d normal_of(const Context& c, const HullFace& face) {
  const Vec3d a = c.vertex(face.first_edge);
  Vec3d sum{};
  for (std::uint16_t e = c.hull.edges[face.first_edge].next; c.hull.edges[e].next != face.first_edge;
       e = c.hull.edges[e].next)
    sum += cross(c.vertex(e) - a, c.vertex(c.hull.edges[e].next) - a);
  return normalize(sum);
}

void add_face(VolumeIntegrals& out, const Context& c, std::size_t f) {
  const HullFace& face = c.hull.faces[f];
  const Vec3d a = c.vertex(face.first_edge);
  for (std::uint16_t e = c.hull.edges[face.first_edge].next; c.hull.edges[e].next != face.first_edge;
       e = c.hull.edges[e].next) {
    const Vec3d b = c.vertex(e), d = c.vertex(c.hull.edges[e].next);
    out.add_tetrahedron(a, b, d);
    if (c.radius > 0) out.add_prism(a, b, d, c.normals[f], c.radius);
  }
}

// Between the normals n and m of two faces that meet at the edge (a, b): a sector of a circle, extruded along the edge.
void add_wedge(VolumeIntegrals& out, const Context& c, Vec3d a, Vec3d b, Vec3d n, Vec3d m) {
  const double r = c.radius, r2 = r * r;
  const Vec3d across = m - dot(n, m) * n;
  const double sine = length(across), cosine = dot(n, m);
  if (!(sine > 0)) return;
  const Vec3d u = across / sine;
  const double theta = math::atan2(sine, cosine), l = length(b - a);
  const double area = theta * r2 / 2;
  // In the plane of the sector, with n and u as axes: ∫p dA and ∫p pᵀ dA.
  const Vec3d p = (r2 * r / 3) * (sine * n + (1 - cosine) * u);
  const double nn = (theta + sine * cosine) / 2, uu = (theta - sine * cosine) / 2, nu = sine * sine / 2;
  const Mat3d pp = (r2 * r2 / 4) * (nn * outer(n, n) + uu * outer(u, u) + nu * (outer(n, u) + outer(u, n)));
  const Vec3d middle = (a + b) * 0.5;
  const Mat3d along = (outer(a, a) + outer(b, b) + 4.0 * outer(middle, middle)) * (1.0 / 6);  // mean of s sᵀ
  out.add(l * area, l * (area * middle + p), l * (area * along + outer(middle, p) + outer(p, middle) + pp));
}

// The solid angle of the spherical triangle (a, b, c): Van Oosterom and Strackee 1983.
double solid_angle(Vec3d a, Vec3d b, Vec3d c) {
  return 2 * math::atan2(max(0.0, triple(a, b, c)), 1 + dot(a, b) + dot(b, c) + dot(c, a));
}

// The piece of the ball about vertex v that lies between the normals of its faces, a spherical polygon seen from the
// centre. With Ω its solid angle and, for each side, a the integral of the unit vector along the arc and n the outward
// normal of the flat side, the divergence theorem gives ∫u uᵀ dΩ = (Ω E − Σ a nᵀ)/3 and ∫u dΩ = ½ Σ θ(−n).
void add_corner(VolumeIntegrals& out, const Context& c, Vec3d v, const std::vector<Vec3d>& normals) {
  const double r = c.radius, r3 = r * r * r;
  double omega = 0;
  Vec3d mean{};
  Mat3d sides = Mat3d::zero();
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3d n = normals[i], m = normals[(i + 1) % normals.size()];
    if (i > 0 && i + 1 < normals.size()) omega += solid_angle(normals[0], n, m);
    const Vec3d inward = cross(n, m);
    const double sine = length(inward), cosine = dot(n, m);
    if (!(sine > 0)) continue;
    const Vec3d side = inward / sine;
    const Vec3d u = cross(side, n);
    mean += (math::atan2(sine, cosine) / 2) * side;
    sides = sides - outer(sine * n + (1 - cosine) * u, side);
  }
  const Mat3d square = (omega * Mat3d::identity() - sides) * (1.0 / 3);
  const double volume = omega * r3 / 3;
  const Vec3d p = (r3 * r / 4) * mean;
  out.add(volume, volume * v + p,
          volume * outer(v, v) + outer(v, p) + outer(p, v) + (r3 * r * r / 5) * 0.5 * (square + transpose(square)));
}

}  // namespace hull_mass

}  // namespace

VolumeIntegrals integrate_hull(const Hull& hull, Vec3d origin) {
  hull_mass::Context c{hull, origin, double(hull.radius), {}};
  for (const HullFace& face : hull.faces) c.normals.push_back(hull_mass::normal_of(c, face));
  VolumeIntegrals out;
  for (std::size_t f = 0; f < hull.faces.size(); ++f) hull_mass::add_face(out, c, f);
  if (!(hull.radius > 0)) return out;

  for (std::size_t e = 0; e < hull.edges.size(); e += 2) {
    const HullEdge &edge = hull.edges[e], &twin = hull.edges[e + 1];
    hull_mass::add_wedge(out, c, c.vertex(std::uint16_t(e)), c.vertex(std::uint16_t(e + 1)), c.normals[edge.face],
                         c.normals[twin.face]);
  }
  std::vector<bool> done(hull.vertices.size(), false);
  std::vector<Vec3d> around;
  for (std::size_t e = 0; e < hull.edges.size(); ++e) {
    const std::uint16_t v = hull.edges[e].origin;
    if (done[v]) continue;
    done[v] = true;
    around.clear();
    // From one outgoing edge to the next counterclockwise round the vertex, as seen from outside: the edge that
    // arrives in this face is its predecessor, whose twin leaves again.
    std::uint16_t edge = std::uint16_t(e);
    do {
      around.push_back(c.normals[hull.edges[edge].face]);
      std::uint16_t arriving = edge;
      while (hull.edges[arriving].next != edge) arriving = hull.edges[arriving].next;
      edge = hull.edges[arriving].twin;
    } while (edge != e);
    hull_mass::add_corner(out, c, Vec3d(hull.vertices[v]) - origin, around);
  }
  return out;
}

}  // namespace carom::geometry::detail
