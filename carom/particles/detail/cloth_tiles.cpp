// A cloth's triangles, edges and vertices by sixteen.
#include <algorithm>

#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

namespace {

/// Enters sides one by one: each lane's first into the first tile of sides, and so on.
void put_side(std::vector<ClothSide>& sides, int first, int& last, int index, std::size_t lane, const ClothSide& side) {
  while (first + index >= last) {
    sides.emplace_back();
    std::fill_n(sides.back().triangle, cloth_lanes, -1);
    ++last;
  }
  ClothSide& to = sides[std::size_t(first) + std::size_t(index)];
  to.triangle[lane] = side.triangle[0];
  to.area[lane] = side.area[0];
  to.ua[lane] = side.ua[0], to.va[lane] = side.va[0];
  to.ub[lane] = side.ub[0], to.vb[lane] = side.vb[0];
}

}  // namespace

void ClothState::tile_triangles() {
  tiles.assign((triangles.size() + cloth_lanes - 1) / cloth_lanes, ClothTile{});
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    ClothTile& tile = tiles[t / cloth_lanes];
    for (std::size_t c = 0; c < 3; ++c) {
      tile.corner[c][t % cloth_lanes] = int(corners[3 * t + c]);
      tile.u[c][t % cloth_lanes] = triangles[t].u[c];
      tile.v[c][t % cloth_lanes] = triangles[t].v[c];
    }
  }
  strains.resize(tiles.size() * cloth_lanes + 1);  // those of before stay: tears look at them
}

void ClothState::tile_sides() {
  const int n = int(position.size());
  const auto side_of = [&](std::size_t t, std::size_t a, std::size_t b) {
    ClothSide side;
    const ClothTriangle& triangle = triangles[t];
    side.triangle[0] = int(t);
    side.area[0] = triangle.area;
    side.ua[0] = triangle.u[a], side.va[0] = triangle.v[a];
    side.ub[0] = triangle.u[b], side.vb[0] = triangle.v[b];
    return side;
  };
  const int none = int(matrix.blocks.size()) - 1;
  vertices.assign(std::size_t(n + cloth_lanes - 1) / cloth_lanes, ClothCorners{});
  edges.clear();
  vertex_sides.clear();
  edge_sides.clear();
  std::size_t at = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    ClothCorners& tile = vertices[k];
    tile.first = tile.last = int(vertex_sides.size());
    for (std::size_t lane = 0; lane < cloth_lanes; ++lane) {
      const std::size_t i = k * cloth_lanes + lane;
      tile.slot[lane] = i < std::size_t(n) ? matrix.diagonal(int(i)) : none;
      if (i >= std::size_t(n)) continue;
      tile.near[lane] = matrix.near[std::size_t(tile.slot[lane])];
      for (int j = triangle_first[i]; j < triangle_first[i + 1]; ++j) {
        const int place = triangle_list[std::size_t(j)];
        put_side(vertex_sides, tile.first, tile.last, j - triangle_first[i], lane,
                 side_of(std::size_t(place) / 3, std::size_t(place) % 3, std::size_t(place) % 3));
      }
      // The edges to vertices of greater numbers.
      for (int slot = matrix.diagonal(int(i)) + 1; slot < matrix.first(int(i) + 1); ++slot, ++at) {
        const std::size_t other = matrix.column(slot), l = at % cloth_lanes;
        if (l == 0) {
          edges.emplace_back();
          edges.back().first = edges.back().last = int(edge_sides.size());
          for (auto& list : edges.back().slot) std::fill_n(list, cloth_lanes, none);
        }
        ClothEdges& edge = edges.back();
        edge.slot[0][l] = slot;
        edge.slot[1][l] = matrix.slot(std::uint32_t(other), std::uint32_t(i));
        edge.near[l] = matrix.near[std::size_t(slot)];
        int index = 0;
        for (int j = triangle_first[i]; j < triangle_first[i + 1]; ++j) {
          const int place = triangle_list[std::size_t(j)];
          for (std::size_t b = 0; b < 3; ++b)
            if (corners[std::size_t(place) / 3 * 3 + b] == other)
              put_side(edge_sides, edge.first, edge.last, index++, l,
                       side_of(std::size_t(place) / 3, std::size_t(place) % 3, b));
        }
      }
    }
  }
  for (auto* list : {&vertex_sides, &edge_sides})
    for (ClothSide& side : *list)
      for (int& triangle : side.triangle)
        if (triangle < 0) triangle = int(strains.size()) - 1;
  records = AlignedFloats(std::size_t(n) * cloth_record);
  rows = AlignedFloats(vertices.size() * cloth_lanes * cloth_row);
}

}  // namespace carom::particles::detail
