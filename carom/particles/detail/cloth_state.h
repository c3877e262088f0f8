// What a cloth keeps, and the passes of its step.
#pragma once

#include "carom/particles/cloth.h"
#include "carom/particles/detail/soft_thing.h"

namespace carom::particles::detail {

struct ClothTriangle {
  float area = 0;              ///< m², at rest
  float x[3] = {}, y[3] = {};  ///< m, corners at rest along warp and weft
  float u[3] = {}, v[3] = {};  ///< gradients of the three corners' shares along warp and weft, 1/m
};

/// A triangle with the corners across its edges: a quadratic through the six gives its curvature (the patch of Oñate
/// and Zárate's rotation-free shell triangles, 2000).
struct ClothPatch {
  std::uint32_t corner[6] = {};  ///< a corner that is missing is the first again, with no weight
  float weight[3][6] = {};       ///< of the positions: curvatures uu, vv, uv, times the root of area and stiffness
};

/// A vertex above or below a triangle of another fold.
struct ClothPair {
  std::uint32_t vertex = 0, triangle = 0;
  Vec3f share{};     ///< of the corners, below the vertex
  Vec3f normal{};    ///< from the triangle to the vertex
  float wanted = 0;  ///< m/s, at least, apart
  float mass = 0;    ///< kg, of the two against each other
};

/// An edge that goes through a triangle, and which way it comes out of it.
struct ClothCrossing {
  std::uint32_t end[2] = {}, triangle = 0;
  float along = 0;  ///< of the edge, 0 to 1
  Vec3f share{};    ///< of the triangle's corners
  Vec3f out{};      ///< unit: the edge against the triangle
  float mass = 0;   ///< kg, of the two against each other
};
/// Two edges of folds that cross.
struct ClothEdgePair {
  std::uint32_t vertex[4] = {};
  float share[4] = {};  ///< of the velocities: that of the first edge less that of the second
  Vec3f normal{};       ///< from the second edge to the first
  float wanted = 0;     ///< m/s, at least, apart
  float mass = 0;       ///< kg, of the two against each other
};
/// The normals of a tile's triangles lie within this cosine of an axis; below 0: not known.
struct FoldCone {
  Vec3f axis{};
  float cosine = -1;
};
struct ClothState final : SoftThing {
  Fabric fabric{};
  bool self_collide = true, self_collide_edges = false, torn = false;
  double air_density = 1.225;
  environment::Wind wind{};
  environment::WindPatch beyond{};

  std::vector<std::uint32_t> corners;  ///< three a triangle
  std::vector<ClothTriangle> triangles;
  std::vector<ClothPatch> patches;
  std::vector<math::Vec3d> pin_impulse;

  // What follows from the mesh.
  std::vector<ClothTile> tiles;  ///< of triangles, in their order
  std::vector<ClothEdges> edges;
  std::vector<ClothCorners> vertices;  ///< in their order
  std::vector<ClothSide> edge_sides, vertex_sides;
  float smallest_edge = 0;
  float far_share = 0;  ///< 1/s²: greatest sum of a vertex's links to those beyond its triangles, by its mass

  std::vector<int> triangle_first, triangle_list;  ///< by vertex: 3·triangle + corner
  std::vector<FoldVertices> fold_vertices;
  std::vector<FoldTriangles> fold_triangles;
  std::vector<FoldEdges> fold_edges;          ///< by tile of triangles
  std::vector<std::vector<int>> fold_beside;  ///< later tiles that share a vertex with it

  // Of a step.
  AlignedFloats records, rows;       ///< by vertex: cloth_record and cloth_row floats
  std::vector<ClothStrain> strains;  ///< by triangle, those that fill the last tile, and one that is none
  std::vector<ClothPair> pairs;
  std::vector<ClothCrossing> crossings;
  std::vector<ClothEdgePair> edge_pairs;
  std::vector<FoldCone> fold_cones;
  std::vector<FoldRun> fold_runs;
  std::vector<SoftVector> fold_records;  ///< by vertex: place from the first, velocity
  std::vector<FoldHit> fold_hits;
  std::vector<EdgeHit> edge_hits;
  std::vector<std::uint8_t> tangled;  ///< by vertex: where folds cross
  math::Vec3d wind_force{};
  double greatest_tension = 0;
  double last_step = 0;  ///< s

  core::Status set_mesh(std::span<const math::Vec3d> rest, math::Vec3d warp);
  void find_patches();
  void tile_triangles();
  void tile_sides();
  void connect();  ///< matrix and incidences, after the mesh changed

  ClothLaw law() const;                   ///< without the weight
  void stretch();                         ///< triangles: strains, stresses, wind
  void assemble(float h, Vec3f gravity);  ///< vertices: the linear system
  void keep_apart(float h);               ///< folds
  float lightness(std::uint32_t i) const {
    return pin_of[i] >= 0 ? 0.0f : 1 / mass[i];
  }  ///< 1/kg; none of what is held
  Vec3f fold_place(std::uint32_t i) const { return fold_records[2 * std::size_t(i)].vector(); }  ///< m, from the first
  /// N·s on what moves with `relative` (m/s) against the other, of two of `heavy` (kg) that part by `wanted` along the
  /// normal: with friction. Zero: they do.
  Vec3f fold_impulse(const Vec3f& relative, const Vec3f& normal, float wanted, float heavy) const;
  void tile_folds();
  void tile_fold_edges();
  void find_fold_pairs(float h, float apart);
  void find_edge_pairs(float h, float apart);
  /// Edges of one tile against those of another, whose triangles' bounds are given.
  void meet_edges(const FoldEdges& ours, const FoldTriangles& bounds, const FoldEdges& theirs, bool same, float h,
                  float apart);
  void lay_cones();
  void lay_runs();
  void push_edges();
  /// Whether an edge of the vertex goes through the triangle, or one of the triangle through one of the vertex's; marks
  /// the vertices of both as tangled.
  bool tangle(std::uint32_t vertex, std::uint32_t triangle);
  void find_ways_out();  ///< of the crossings that were found, each once
  bool drawn_out(std::uint32_t triangle) const;
  /// False: it only touches, or the cloth is drawn out there.
  bool find_way_out(ClothCrossing& crossing) const;
  void push_out(float h, float apart);
  void tear();

  std::span<const std::uint32_t> faces() const override { return corners; }
  void begin_step(rigid::World3& world, double dt) override;
  void begin_substep(float h, Vec3f gravity) override;
  void end_substep(float h) override;
  void end_step(rigid::World3& world, double dt) override;
};

}  // namespace carom::particles::detail
