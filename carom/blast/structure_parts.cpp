// Structures from pieces, and what they are made of.
#include "carom/blast/structure.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

BondMaterial bond_material(Substance substance) {
  switch (substance) {
    case Substance::glass:
      return {3e7, 5e8, 3e7, 7e10, 5e-4};
    case Substance::brick_and_mortar:
      return {3e5, 8e6, 4e5, 5e9, 2e-3};
    case Substance::concrete:
      return {3e6, 3e7, 4e6, 3e10, 1e-3};
    case Substance::ceramic:
      return {3e7, 3e8, 3e7, 6e10, 5e-4};
    case Substance::wood:
      return {4e7, 4e7, 8e6, 1.1e10, 2e-3};
    case Substance::ice:
      return {1e6, 5e6, 1e6, 9e9, 1e-3};
  }
  return {};
}

double density_of(Substance substance) {
  switch (substance) {
    case Substance::glass:
      return 2500;
    case Substance::brick_and_mortar:
      return 1900;
    case Substance::concrete:
      return 2400;
    case Substance::ceramic:
      return 2300;
    case Substance::wood:
      return 600;
    case Substance::ice:
      return 917;
  }
  return 1000;
}

namespace {

/// Parts for the pieces that have shapes; what others weigh goes to the neighbour with the largest bond.
template <class D, class Piece, class Bond, class Shapes, class Size>
StructureDef<D> assemble(const std::vector<Piece>& pieces, const std::vector<Bond>& bonds, double density,
                         Shapes&& shapes, Size&& size) {
  StructureDef<D> d;
  std::vector<std::uint32_t> part(pieces.size(), ground);
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    typename StructureDef<D>::Part p;
    shapes(pieces[i], p.shapes);
    if (p.shapes.empty()) continue;
    p.mass = pieces[i].mass;
    p.mass.mass *= density;
    p.mass.inertia = density * p.mass.inertia;
    part[i] = std::uint32_t(d.parts.size());
    d.parts.push_back(std::move(p));
  }
  std::vector<double> largest(pieces.size(), 0);
  std::vector<std::uint32_t> heir(pieces.size(), ground);
  for (const Bond& b : bonds) {
    if (part[b.a] != ground && part[b.b] != ground) {
      typename StructureDef<D>::Joint joint;
      joint.a = part[b.a], joint.b = part[b.b], joint.area = size(b), joint.center = b.center, joint.normal = b.normal;
      d.bonds.push_back(joint);
      continue;
    }
    if (part[b.a] == ground && part[b.b] != ground && size(b) > largest[b.a])
      largest[b.a] = size(b), heir[b.a] = part[b.b];
    if (part[b.b] == ground && part[b.a] != ground && size(b) > largest[b.b])
      largest[b.b] = size(b), heir[b.b] = part[b.a];
  }
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (part[i] != ground || heir[i] == ground) continue;
    d.parts[heir[i]].mass.mass += density * pieces[i].mass.mass;  // its centre moves by less than such a piece is thick
  }
  return d;
}

}  // namespace

StructureDef<Dim3> structure_of(const Fracture& fracture, double density) {
  return assemble<Dim3>(
      fracture.pieces, fracture.bonds, density,
      [](const Piece& p, std::vector<geometry::Shape3>& shapes) {
        for (const auto& hull : p.hulls) shapes.emplace_back(hull);
      },
      [](const Bond& b) { return b.area; });
}
StructureDef<Dim2> structure_of(const Fracture2& fracture, double density) {
  return assemble<Dim2>(
      fracture.pieces, fracture.bonds, density,
      [](const Piece2& p, std::vector<geometry::Shape2>& shapes) {
        for (const auto& polygon : p.polygons) shapes.emplace_back(polygon);
      },
      [](const Bond2& b) { return b.length; });
}

void anchor_below(StructureDef<Dim3>& d, double level) {
  for (std::uint32_t i = 0; i < d.parts.size(); ++i) {
    Vec3d low{1e300, 1e300, 1e300}, high = -low;
    for (const auto& shape : d.parts[i].shapes) {
      const geometry::Bounds3f b = geometry::bounds(shape, {});
      low = min(low, Vec3d(b.low) + d.parts[i].mass.center), high = max(high, Vec3d(b.high) + d.parts[i].mass.center);
    }
    if (!(low.y < level)) continue;
    StructureDef<Dim3>::Joint joint;
    joint.a = i, joint.b = ground, joint.area = (high.x - low.x) * (high.z - low.z);
    joint.center = {0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z)}, joint.normal = {0, -1, 0};
    d.bonds.push_back(joint);
  }
}
void anchor_below(StructureDef<Dim2>& d, double level) {
  for (std::uint32_t i = 0; i < d.parts.size(); ++i) {
    Vec2d low{1e300, 1e300}, high = -low;
    for (const auto& shape : d.parts[i].shapes) {
      const geometry::Bounds2f b = geometry::bounds(shape, {});
      low = min(low, Vec2d(b.low) + d.parts[i].mass.center), high = max(high, Vec2d(b.high) + d.parts[i].mass.center);
    }
    if (!(low.y < level)) continue;
    StructureDef<Dim2>::Joint joint;
    joint.a = i, joint.b = ground, joint.area = high.x - low.x;
    joint.center = {0.5 * (low.x + high.x), low.y}, joint.normal = {0, -1};
    d.bonds.push_back(joint);
  }
}

}  // namespace carom::blast
