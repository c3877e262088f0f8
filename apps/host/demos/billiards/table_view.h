// What a billiard table and its balls look like: a mesh from the outline, balls with stripes and spots that show how
// they turn, and the cue.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/sports/billiards_engine.h"

namespace carom::host::demo {

struct TableColors {
  std::uint32_t cloth = 0x0a5c34, cushion = 0x0d6e40, wood = 0x552a0e;
};

/// Adds the table as fixed bodies that nothing collides with: bed, cushions, rails with sights, pockets, legs.
void add_table(Stage3& stage, const sports::BilliardTable& table, const TableColors& colors = {});

/// The balls of a game as bodies that are moved along the engine's paths.
class BallBodies {
 public:
  enum class Kind { plain, solid, stripe };
  struct Look {
    std::uint32_t color = 0xf4f0e4;
    Kind kind = Kind::plain;
  };
  /// The cue ball, then 1 to 15 of pool.
  static std::vector<Look> pool();
  static std::vector<Look> snooker();
  static std::vector<Look> carom();
  static std::vector<Look> russian();

  void add(Stage3& stage, const sports::Billiards& game, const std::vector<Look>& looks);
  /// Shows the balls as they are at the game's time `time`; `dt` s have passed since the last time.
  void show(Stage3& stage, const sports::Billiards& game, double time, double dt);
  /// The balls lie anew: their turning starts again.
  void reset();
  math::Vec3d shown(int ball) const { return shown_[std::size_t(ball)]; }

 private:
  std::vector<rigid::BodyId> bodies_;
  std::vector<math::Quatd> turned_;
  std::vector<math::Vec3d> shown_;
  double tray_ = 0;
};

/// The cue: a body that points at the ball where it will be struck, or lies aside.
class CueBody {
 public:
  void add(Stage3& stage);
  /// Its tip `back` m away from the point of the ball that it strikes.
  void aim(Stage3& stage, const math::Vec3d& ball, double radius, const sports::Stroke& stroke, double back);
  void put_away(Stage3& stage, const math::Vec3d& place);

 private:
  rigid::BodyId body_{};
};

/// Lines of the next shot, from a copy of the game: the cue ball's way, the ghost ball, the object balls' ways.
void draw_preview(Stage3& stage, const sports::Billiards& game, int cue_ball, const sports::Stroke& stroke,
                  const sports::Cue& cue, int cushions);
/// A ball's way between two times.
void draw_path(Stage3& stage, const sports::Billiards& game, int ball, double from, double until, std::uint32_t rgba);
void draw_circle(Stage3& stage, const math::Vec3d& middle, double radius, std::uint32_t rgba);

}  // namespace carom::host::demo
