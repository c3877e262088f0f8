#include "carom/sports/billiards_rack.h"

#include "carom/math/random.h"

namespace carom::sports {

using math::Vec2d;

namespace {

std::vector<Vec2d> rack_rows(std::vector<int> rows, Vec2d apex, double radius, const RackOptions& options) {
  const double spacing = 2 * radius + options.gap;
  math::Random random(options.seed, 0x7ac4);
  std::vector<Vec2d> balls;
  for (std::size_t row = 0; row < rows.size(); ++row)
    for (int i = 0; i < rows[row]; ++i) {
      const Vec2d place{apex.x + double(row) * (math::sqrt(0.75) * spacing),
                        apex.y + (2 * i - rows[row] + 1) * (0.5 * spacing)};
      const Vec2d off =
          options.jitter > 0 ? math::min(options.jitter, 1.0) * 0.5 * options.gap * random.in_disc() : Vec2d{};
      balls.push_back(place + off);
    }
  return balls;
}

}  // namespace

std::vector<Vec2d> triangle_rack(int rows, Vec2d apex, double radius, const RackOptions& options) {
  std::vector<int> sizes;
  for (int i = 1; i <= rows; ++i) sizes.push_back(i);
  return rack_rows(sizes, apex, radius, options);
}

std::vector<Vec2d> eight_ball_rack(const RectangularTable& table, double radius, const RackOptions& options) {
  std::vector<Vec2d> balls = triangle_rack(5, {table.length / 4, 0}, radius, options);
  balls.insert(balls.begin(), {-table.length / 4, 0});
  return balls;
}

std::vector<Vec2d> nine_ball_rack(const RectangularTable& table, double radius, const RackOptions& options) {
  std::vector<Vec2d> balls = rack_rows({1, 2, 3, 2, 1}, {table.length / 4, 0}, radius, options);
  balls.insert(balls.begin(), {-table.length / 4, 0});
  return balls;
}

std::vector<Vec2d> snooker_rack(const RectangularTable& table, double radius, const RackOptions& options) {
  const double scale = table.length / 3.569, half = table.length / 2;
  const double baulk = -half + 0.737 * scale, side = 0.292 * scale, pink = table.length / 4;
  std::vector<Vec2d> balls = {
      {baulk - 0.5 * side, -0.4 * side}, {baulk, side}, {baulk, -side}, {baulk, 0}, {0, 0}, {pink, 0},
      {half - 0.324 * scale, 0}};
  const double apart = math::max(options.gap, 0.001);  // as near to the pink as can be without touching it
  for (const Vec2d red : triangle_rack(5, {pink + 2 * radius + apart, 0}, radius, options)) balls.push_back(red);
  return balls;
}

std::vector<Vec2d> carom_opening(const RectangularTable& table, double radius) {
  const double beside = math::max(0.1825 * table.width / 1.42, 2.5 * radius);
  return {{-table.length / 4, beside}, {-table.length / 4, 0}, {table.length / 4, 0}};
}

}  // namespace carom::sports
