// Triangles, edges and vertices of a cloth by sixteen, and what the kernels make of them.
#pragma once

#include "carom/math/vec.h"

namespace carom::particles::detail {

inline constexpr int cloth_lanes = 16;

/// Floats by vertex: place in two parts and velocity, four each.
inline constexpr int cloth_record = 12;
/// Floats by vertex: force, rub; the squares and then the products (xy, yz, zx) of the normals that are braked.
inline constexpr int cloth_row = 12;

/// Of a triangle in this substep.
struct alignas(16) ClothStrain {
  float along[3] = {}, warp = 0;   ///< image of the unit warp; its stress, N/m
  float across[3] = {}, weft = 0;  ///< of the weft
  float pull[3] = {}, shear = 0;   ///< the stress's part that pulls: warp, weft, shear; shear stress
  float wind[3] = {}, brake = 0;   ///< N on each corner; N·s/m on each corner along the normal, beyond `rub`
  float normal[3] = {}, rub = 0;   ///< N·s/m in all directions

  math::Vec3f image_of_warp() const { return {along[0], along[1], along[2]}; }
  math::Vec3f image_of_weft() const { return {across[0], across[1], across[2]}; }
  /// N/m: the greater principal stress.
  float tension() const {
    const float difference = 0.5f * (warp - weft);
    return 0.5f * (warp + weft) + math::sqrt(difference * difference + shear * shear);
  }
};
inline constexpr int cloth_strain = sizeof(ClothStrain) / sizeof(float);

struct alignas(64) ClothTile {
  int corner[3][cloth_lanes] = {};
  float u[3][cloth_lanes] = {}, v[3][cloth_lanes] = {};  ///< gradients of the corners' shares, 1/m
  float air[3][cloth_lanes] = {};                        ///< m/s
};

/// A triangle at an edge, or at a vertex.
struct alignas(64) ClothSide {
  int triangle[cloth_lanes] = {};
  float area[cloth_lanes] = {};                      ///< m²; 0: none
  float ua[cloth_lanes] = {}, va[cloth_lanes] = {};  ///< gradients of the first end's share
  float ub[cloth_lanes] = {}, vb[cloth_lanes] = {};  ///< of the other end's
};
struct alignas(64) ClothEdges {
  int slot[2][cloth_lanes] = {};  ///< of the blocks (a, b) and (b, a)
  float near[cloth_lanes] = {};   ///< bending
  int first = 0, last = 0;        ///< sides
};
struct alignas(64) ClothCorners {
  int slot[cloth_lanes] = {};
  float near[cloth_lanes] = {};
  int first = 0, last = 0;
};

struct ClothLaw {
  float warp = 0, both = 0, weft = 0, shear = 0;  ///< N/m
  float press = 0, rub = 0;                       ///< kg/m³: ½ ρ C
  float weight = 0;                               ///< s²: of the stiffness
};

}  // namespace carom::particles::detail
