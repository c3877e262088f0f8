// Cells, patterns and pieces. Their published laws are in tests/published/chapter_18_fracture_test.cpp.

#include <gtest/gtest.h>

#include "carom/geometry/query.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "tests/blast/fracture_support.h"

namespace blast_test {
using namespace fracture_test;

TEST(ConvexCell, CutsOfABox) {
  ConvexCell cell = unit_box();
  EXPECT_NEAR(cell.volume(), 1, 1e-15);
  EXPECT_EQ(cell.clip({{1, 0, 0}, 2, 7}), ConvexCell::Cut::none);
  EXPECT_EQ(cell.clip({{1, 0, 0}, 0.25, 7}), ConvexCell::Cut::part);
  EXPECT_NEAR(cell.volume(), 0.25, 1e-15);
  EXPECT_EQ(cell.faces().size(), 6u);
  // A corner off: 1/6 of the cube of the edge.
  const Vec3d n = normalize(Vec3d{1, 1, 1});
  ConvexCell corner = unit_box();
  corner.clip({-n, -dot(n, Vec3d{0.5, 0, 0}), 3});
  EXPECT_NEAR(corner.volume(), 1 - 0.125 / 6, 1e-15);
  EXPECT_EQ(int(corner.vertices().size()) - corner.edge_count() + int(corner.faces().size()), 2);
  EXPECT_EQ(corner.clip({n, -1, 3}), ConvexCell::Cut::all);
  EXPECT_TRUE(corner.empty());
}

TEST(ConvexCell, HullsAreCellsWithEveryFaceMovedInward) {
  const ConvexCell box = unit_box();
  const Pattern pattern = voronoi_pattern(box, uniform_sites(box, 150, 5)).value();
  for (const double skin : {0.0, 1e-4, 1e-3, 0.01}) {
    int hulls = 0;
    for (const ConvexCell& cell : pattern.cells) {
      ConvexCell cut = cell;
      for (const ConvexCell::Face& face : cell.faces())
        if (skin > 0) (void)cut.clip({face.normal, face.offset - skin, face.tag});
      const Vec3d origin = cell.mass_properties(1).center;
      const auto hull = make_cell_hull(cell, origin, skin);
      if (hull == nullptr) {
        EXPECT_LT(cut.volume(), 1e-4) << "only of thin ones nothing is left";
        continue;
      }
      ++hulls;
      const auto expected = cut.mass_properties(1);
      EXPECT_NEAR(hull->volume, expected.mass, 1e-6 * expected.mass);
      EXPECT_LT(distance(Vec3d(hull->centroid), expected.center - origin), 1e-6);
      EXPECT_TRUE(geometry::validate_hull(*hull, {}, 2e-5).ok());
    }
    EXPECT_GT(hulls, skin < 0.005 ? 147 : 130);
  }
  EXPECT_EQ(make_cell_hull(ConvexCell(geometry::Bounds3d{{0, 0, 0}, {1, 1, 0.01}}), {}, 0.006), nullptr)
      << "the two sides would pass each other";
}

TEST(Fracture, CellsAreWhatTheCutsOfAllSitesLeave) {
  // Containers of three edges a corner, of four, of five, and of more faces than the fast cuts hold; sites by chance,
  // and on a lattice, where cuts go through corners.
  std::vector<std::pair<const char*, ConvexCell>> containers{{"box", unit_box()}};
  math::Random random(4);
  const std::vector<math::Vec3f> octahedron{{1, .5f, .5f}, {0, .5f, .5f}, {.5f, 1, .5f},
                                            {.5f, 0, .5f}, {.5f, .5f, 1}, {.5f, .5f, 0}};
  containers.emplace_back("octahedron", ConvexCell(*geometry::make_hull(octahedron).value()));
  for (const int count : {12, 100}) {
    std::vector<math::Vec3f> points;
    for (int i = 0; i < count; ++i) points.push_back(math::Vec3f(Vec3d{.5, .5, .5} + 0.5 * random.on_sphere()));
    containers.emplace_back(count == 12 ? "ball of 12" : "ball of 100",
                            ConvexCell(*geometry::make_hull(points).value()));
  }
  for (const auto& [name, container] : containers) {
    std::vector<Vec3d> lattice;
    for (int i = 0; i < 64; ++i)
      lattice.push_back({0.25 * (i % 4) + 0.125, 0.25 * (i / 4 % 4) + 0.125, 0.25 * (i / 16) + 0.125});
    for (const auto& sites : {uniform_sites(container, 60, 9), lattice}) {
      const auto pattern = voronoi_pattern(container, sites);
      ASSERT_TRUE(pattern) << pattern.error().message;
      double volume = 0;
      for (std::size_t i = 0; i < sites.size(); ++i) {
        const ConvexCell& cell = pattern->cells[i];
        ConvexCell cut = container;
        for (std::size_t j = 0; j < sites.size(); ++j) {
          if (i == j || cut.empty()) continue;
          const Vec3d n = normalize(sites[j] - sites[i]);
          cut.clip({n, dot(n, 0.5 * (sites[i] + sites[j])), int(j)});
        }
        ASSERT_EQ(cell.empty(), cut.empty()) << name << ", cell " << i;
        if (cell.empty()) continue;
        volume += cell.volume();
        EXPECT_NEAR(cell.volume(), cut.volume(), 1e-12) << name << ", cell " << i;
        EXPECT_EQ(int(cell.vertices().size()) - cell.edge_count() + int(cell.faces().size()), 2) << name << i;
        if (cut.volume() > 1e-9)
          EXPECT_LT(distance(cell.mass_properties(1).center, cut.mass_properties(1).center), 1e-9) << name << i;
      }
      EXPECT_NEAR(volume, container.volume(), 1e-12) << name;
    }
  }
}

TEST(Fracture, SameOnAnyNumberOfThreads) {
  const ConvexCell box(geometry::Bounds3d{{0, 0, 0}, {1, 1, 1}});
  const auto sites = uniform_sites(box, 150, 8);
  const auto pool = core::make_thread_pool(3);
  const auto one = fracture_convex(voronoi_pattern(box, sites).value(), {}).value(),
             many = fracture_convex(voronoi_pattern(box, sites, pool.get()).value(), {.scheduler = pool.get()}).value();
  ASSERT_EQ(one.pieces.size(), many.pieces.size());
  ASSERT_EQ(one.bonds.size(), many.bonds.size());
  for (std::size_t i = 0; i < one.pieces.size(); ++i) {
    EXPECT_EQ(one.pieces[i].mass.mass, many.pieces[i].mass.mass);
    EXPECT_EQ(one.pieces[i].vertices, many.pieces[i].vertices);
    ASSERT_EQ(one.pieces[i].hulls.size(), many.pieces[i].hulls.size());
    for (std::size_t h = 0; h < one.pieces[i].hulls.size(); ++h)
      EXPECT_EQ(one.pieces[i].hulls[h]->vertices, many.pieces[i].hulls[h]->vertices);
  }
  for (std::size_t i = 0; i < one.bonds.size(); ++i) EXPECT_EQ(one.bonds[i].area, many.bonds[i].area);
  std::vector<Vec3d> doubled = sites;
  doubled.push_back(sites[3]);
  EXPECT_EQ(voronoi_pattern(box, doubled, pool.get()).error().message,
            "voronoi_pattern: sites 3 and 150 are in one place");
}

TEST(FractureMesh, HullsStandApartAndBondsCoverTheCuts) {
  for (const MeshCase& m : mesh_cases()) {
    const std::vector<Vec3d> vertices(m.mesh.positions.begin(), m.mesh.positions.end());
    const ConvexCell box = container_of(vertices);
    const auto f =
        fracture_mesh(vertices, m.mesh.indices, voronoi_pattern(box, uniform_sites(box, m.count / 2, 2)).value());
    ASSERT_TRUE(f);
    double cut = 0, bonded = 0;
    for (const Piece& p : f->pieces) {
      for (std::size_t t = 0; t < p.sources.size(); ++t) {
        if (p.sources[t] >= 0) continue;
        const Vec3d a = p.vertices[p.triangles[3 * t]], b = p.vertices[p.triangles[3 * t + 1]],
                    c = p.vertices[p.triangles[3 * t + 2]];
        cut += 0.5 * length(cross(b - a, c - a));
      }
      for (const auto& hull : p.hulls) {
        const auto sound = geometry::validate_hull(*hull, {}, 3e-5);
        EXPECT_TRUE(sound.ok()) << m.name << sound.error().message;
      }
    }
    for (const Bond& b : f->bonds) bonded += b.area;
    // Each bond is two faces, one of each piece.
    EXPECT_NEAR(2 * bonded, cut, 1e-6 * cut) << m.name;
    int overlaps = 0;
    for (std::size_t i = 0; i < f->pieces.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        for (const auto& a : f->pieces[i].hulls)
          for (const auto& b : f->pieces[j].hulls) {
            const math::Transform3f way{math::Vec3f(f->pieces[j].mass.center - f->pieces[i].mass.center), {}};
            overlaps += geometry::distance(geometry::Shape3(a), geometry::Shape3(b), way).distance <= 0;
          }
    EXPECT_EQ(overlaps, 0) << m.name;
  }
}

// The surface keeps the picture that it had: linear in a triangle, so that a point of it has the coordinates of the
// triangle it came from. Cuts get coordinates in metres of their plane, the same from both sides.
TEST(FractureMesh, TextureCoordinates) {
  const geometry::Triangles mesh = geometry::make_box_mesh({0.5, 0.75, 1});
  const std::vector<Vec3d> vertices(mesh.positions.begin(), mesh.positions.end());
  const auto picture = [](Vec3d p) {
    return math::Vec2f{float(0.3 * p.x - 0.5 * p.y + p.z), float(p.x + 0.2 * p.y + 0.4)};
  };
  std::vector<math::Vec2f> corners;
  for (const std::uint32_t i : mesh.indices) corners.push_back(picture(vertices[i]));
  const ConvexCell box = container_of(vertices);
  const Pattern pattern = voronoi_pattern(box, uniform_sites(box, 25, 7)).value();
  constexpr double scale = 3;
  const auto f = fracture_mesh(vertices, mesh.indices, pattern, {.hulls = false, .texture_scale = scale}, corners);
  ASSERT_TRUE(f) << f.error().message;
  struct CutCorner {
    Vec3d place;
    math::Vec2f texture;
    std::uint32_t cell, beyond;
  };
  std::vector<CutCorner> cuts;
  int surface = 0;
  for (const Piece& p : f->pieces) {
    ASSERT_EQ(p.texture.size(), p.triangles.size());
    for (std::size_t t = 0; t < p.sources.size(); ++t) {
      const auto place = [&](std::size_t k) { return p.vertices[p.triangles[3 * t + k]]; };
      for (std::size_t k = 0; k < 3; ++k) {
        const math::Vec2f here = p.texture[3 * t + k], after = p.texture[3 * t + (k + 1) % 3];
        if (p.sources[t] >= 0) {
          const math::Vec2f expected = picture(place(k));
          EXPECT_NEAR(here.x, expected.x, 1e-5f);
          EXPECT_NEAR(here.y, expected.y, 1e-5f);
          ++surface;
        } else {
          EXPECT_NEAR(length(after - here), scale * length(place((k + 1) % 3) - place(k)), 1e-5);
          cuts.push_back({place(k), here, p.cell, std::uint32_t(-1 - p.sources[t])});
        }
      }
    }
  }
  EXPECT_GT(surface, 100);
  int both = 0;
  for (const CutCorner& a : cuts)
    for (const CutCorner& b : cuts) {
      if (a.cell != b.beyond || b.cell != a.beyond || length(a.place - b.place) > 1e-9) continue;
      EXPECT_NEAR(a.texture.x, b.texture.x, 1e-5f);
      EXPECT_NEAR(a.texture.y, b.texture.y, 1e-5f);
      ++both;
    }
  EXPECT_GT(both, 100);
}

TEST(FractureMesh, BadMeshesAreRefused) {
  geometry::Triangles box = geometry::make_box_mesh({1, 1, 1});
  std::vector<Vec3d> vertices(box.positions.begin(), box.positions.end());
  const Pattern pattern = slab_pattern(container_of(vertices), {1, 0, 0}, 2).value();
  std::vector<std::uint32_t> open(box.indices.begin() + 3, box.indices.end());
  const auto f = fracture_mesh(vertices, open, pattern);
  ASSERT_FALSE(f);
  EXPECT_NE(f.error().message.find("fracture_mesh: "), std::string::npos);
  EXPECT_NE(f.error().message.find("open"), std::string::npos) << f.error().message;
  vertices[0].x = math::sqrt(-1.0);
  EXPECT_FALSE(fracture_mesh(vertices, box.indices, pattern));
  EXPECT_FALSE(fracture_convex(pattern, {.skin = -1}));
  EXPECT_FALSE(voronoi_pattern(unit_box(), {}));
  EXPECT_FALSE(brick_pattern(unit_box(), {0, 1, 1}, {}));
  const std::vector<Vec3d> twins{{.5, .5, .5}, {.5, .5, .5}};
  EXPECT_EQ(voronoi_pattern(unit_box(), twins).error().message, "voronoi_pattern: sites 0 and 1 are in one place");
  const Vec3d far_away[] = {{0.2, 0.2, 0.2}, {1e120, 0, 0}};
  EXPECT_EQ(voronoi_pattern(unit_box(), far_away).error().message,
            "voronoi_pattern: site 1 is not finite, or more than 1e30 m away");
}

}  // namespace blast_test
