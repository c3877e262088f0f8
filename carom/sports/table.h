// Tables: the outline of the cushions' noses as any polygon, with rounded jaws, and pockets (chapter 19.3).
//
// Seen from above the coordinates are (x, z); the middle of the preset tables is the origin and their length lies
// along x. Cushions are edges at the height `nose_height`; behind them lies the top of the rail at the same height.
#pragma once

#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::sports {

/// A corner of the outline, and the edge that leads from it to the next.
struct TableCorner {
  math::Vec2d point{};  ///< m, (x, z)
  double rounding = 0;  ///< m, radius of the rubber where the corner points into the table (a pocket's jaw)
  bool open = false;    ///< the edge to the next corner is no cushion: a pocket lies there
};

struct TablePocket {
  math::Vec2d center{};  ///< m, (x, z)
  double radius = 0.06;  ///< m: a ball whose centre comes within falls
};

struct TableDef {
  std::vector<TableCorner> outline{};  ///< a simple polygon, either way round
  std::vector<TablePocket> pockets{};
  double nose_height = 0.036576;  ///< m above the bed, from R to below 2R
  double rail_width = 0.13;       ///< m, of the rail behind the nose: beyond it a flying ball has left the table
};

/// A rectangular table: what makes up its outline. Lengths in m, angles in rad.
struct RectangularTable {
  double length = 1.9812, width = 0.9906;  ///< between the noses
  double nose_height = 0.036576;
  double rail_width = 0.13;
  bool pockets = true;
  // Two jaws a pocket: the mouth is as wide as the corners of the noses are apart, before they are rounded.
  double corner_mouth = 0.118, corner_angle = math::radians(142.0);  ///< between nose and facing, inside the rubber
  double corner_depth = 0.0417, corner_radius = 0.062, corner_rounding = 0.02;
  double side_mouth = 0.137, side_angle = math::radians(104.0);
  double side_depth = 0.0437, side_radius = 0.0645, side_rounding = 0.01;
};
CAROM_API core::Result<TableDef> make_table(const RectangularTable& shape);

// The sizes of play of pool tables, and their pockets as in pooltool's sets; WPA's angles of the jaws (142° and 104°).
CAROM_API RectangularTable seven_foot_pool();  ///< 1.9812 m × 0.9906 m
CAROM_API RectangularTable eight_foot_pool();  ///< 2.2352 m × 1.1176 m
CAROM_API RectangularTable nine_foot_pool();   ///< 2.54 m × 1.27 m
CAROM_API RectangularTable snooker_table();    ///< 3.5445 m × 1.7465 m, pockets with curved jaws
CAROM_API RectangularTable carom_table();      ///< 2.84 m × 1.42 m, no pockets
CAROM_API RectangularTable russian_table();    ///< 3.55 m × 1.775 m, pockets little wider than a ball

/// The pieces that a ball can meet, found from the outline once.
class CAROM_API BilliardTable {
 public:
  struct Edge {
    math::Vec2d from{}, along{}, inward{};  ///< unit vectors
    double length = 0;
    double offset = 0;  ///< dot(inward, point) on the nose
  };
  struct Jaw {
    math::Vec2d center{};
    double radius = 0;
  };
  /// Pieces near a pocket: whoever stays away from the circle meets none of them.
  struct Group {
    math::Vec2d center{};
    double reach = 0;  ///< m, to the farthest point of the pieces
    int pocket = 0;
    std::vector<int> edges{}, jaws{};
  };

  /// Errors: what is not finite or not positive, an outline that crosses itself, corners too sharp for their rounding,
  /// open edges whose ends no pocket covers.
  static core::Result<BilliardTable> create(const TableDef& definition);
  static core::Result<BilliardTable> create(const RectangularTable& shape);

  const TableDef& definition() const { return definition_; }
  const std::vector<Edge>& edges() const { return edges_; }
  const std::vector<Jaw>& jaws() const { return jaws_; }
  const std::vector<TablePocket>& pockets() const { return definition_.pockets; }
  const std::vector<Group>& groups() const { return groups_; }
  const std::vector<int>& free_edges() const { return free_edges_; }  ///< in no group
  const std::vector<int>& free_jaws() const { return free_jaws_; }
  double nose_height() const { return definition_.nose_height; }

  /// Whether a point lies within the outline.
  bool inside(math::Vec2d point) const;
  /// How far (m) a point is from the nearest piece of rubber, seen from above; negative inside rubber is not told
  /// apart.
  double clearance(math::Vec2d point) const;
  /// The pocket within whose circle the point lies, or −1.
  int pocket_at(math::Vec2d point) const;
  /// The outline as it is drawn: roundings as short chords; `open` as in the definition.
  std::vector<TableCorner> drawn_outline(int chords = 6) const;

 private:
  TableDef definition_;
  std::vector<Edge> edges_;
  std::vector<Jaw> jaws_;
  std::vector<Group> groups_;
  std::vector<int> free_edges_, free_jaws_;
};

}  // namespace carom::sports
