#include "carom/ballistics/aim.h"
#include "carom/core/string.h"

namespace carom::ballistics {

using math::Vec3d;

core::Result<AimTable> AimTable::make(const Projectile& projectile, const Conditions& conditions,
                                      const AimTableDef& definition) {
  const auto refuse = [](const char* name, double value, const char* expected) {
    return core::Error{core::text("AimTable: ", core::refused(name, value, expected))};
  };
  if (!(definition.muzzle_speed > 0) || !math::is_finite(definition.muzzle_speed))
    return refuse("muzzle_speed", definition.muzzle_speed, "a finite number > 0");
  if (!(definition.longest_range > 0) || !math::is_finite(definition.longest_range))
    return refuse("longest_range", definition.longest_range, "a finite number > 0");
  if (!(definition.least_elevation > -math::pi / 2))
    return refuse("least_elevation", definition.least_elevation, "more than -pi/2");
  if (!(definition.most_elevation > definition.least_elevation && definition.most_elevation < math::pi / 2))
    return refuse("most_elevation", definition.most_elevation, "more than least_elevation and less than pi/2");
  if (definition.ranges < 2 || definition.ranges > 1024) return refuse("ranges", definition.ranges, "2 to 1024");
  if (definition.elevations < 3 || definition.elevations > 1024)
    return refuse("elevations", definition.elevations, "3 to 1024");
  Conditions still = conditions;
  still.wind = {};
  AimTable table;
  table.definition_ = definition;
  table.nodes_.resize(std::size_t(definition.ranges) * std::size_t(definition.elevations));
  const double reach = definition.longest_range;
  for (int k = 0; k < definition.elevations; ++k) {
    const double elevation = definition.least_elevation +
                             (definition.most_elevation - definition.least_elevation) * k / (definition.elevations - 1);
    const auto flight = fly(projectile, still, {{}, definition.muzzle_speed * direction(elevation)},
                            {.time = 600, .ground = -2 * reach, .distance = 1.001 * reach, .tolerance = 1e-7});
    if (!flight.ok()) return flight.error();
    const double farthest = flight->end().position.x;
    for (int i = 0; i < definition.ranges; ++i) {
      Node& node = table.nodes_[std::size_t(i) * std::size_t(definition.elevations) + std::size_t(k)];
      const double range = reach * i / (definition.ranges - 1);
      if (i == 0) {
        node = {0, float(math::tan(elevation)), 0};
      } else if (const auto point = range < farthest ? flight->at_distance(range) : std::nullopt; point) {
        node = {float(point->position.y), float(point->velocity.y / point->velocity.x), float(point->time)};
      } else {
        node = {float(-4 * reach), 0, -1};
      }
    }
  }
  return table;
}

AimTable::Entries AimTable::at(double range, double height) const {
  Entries entries;
  const int columns = definition_.ranges, rows = definition_.elevations;
  const double cell = definition_.longest_range / (columns - 1), place = range / cell;
  if (!(place > 0) || place > columns - 1) return entries;
  const int i = math::min(int(place), columns - 2);
  const double s = place - i, s2 = s * s, s3 = s2 * s;
  const Node *near = nodes_.data() + i * rows, *far = near + rows;
  // Along the path by Hermite's cubic.
  const double h0 = 2 * s3 - 3 * s2 + 1, h1 = (s3 - 2 * s2 + s) * cell, h2 = 3 * s2 - 2 * s3, h3 = (s3 - s2) * cell;
  const auto over = [&](int k) {
    if (far[k].time < 0) return -4 * definition_.longest_range;
    return h0 * near[k].height + h1 * near[k].slope + h2 * far[k].height + h3 * far[k].slope - height;
  };
  // One hill over the elevations: its top by halving on the side it rises to.
  int low = 0, high = rows - 1;
  while (low < high) {
    const int middle = (low + high) / 2;
    (over(middle + 1) > over(middle) ? low : high) = over(middle + 1) > over(middle) ? middle + 1 : middle;
  }
  const int top = low;
  if (over(top) < 0) return entries;
  const auto between = [&](int below, int above) {  // over(below) < 0 ≤ over(above)
    while (math::abs(above - below) > 1) {
      const int middle = (above + below) / 2;
      (over(middle) < 0 ? below : above) = middle;
    }
    const double a = over(below), b = over(above), t = -a / (b - a);
    const auto time = [&](int k) { return near[k].time + s * (far[k].time - near[k].time); };
    const double spacing = (definition_.most_elevation - definition_.least_elevation) / (rows - 1);
    const double at_below = far[below].time < 0 ? time(above) : time(below);
    return Entry{definition_.least_elevation + spacing * (below + t * (above - below)),
                 at_below + t * (time(above) - at_below)};
  };
  if (over(0) < 0) entries.low = between(0, top);
  if (over(rows - 1) < 0) entries.high = between(rows - 1, top);
  if (!entries.low) entries.low = entries.high;
  if (!entries.high) entries.high = entries.low;
  return entries;
}

Aims AimTable::aim(const Shooter& shooter, const Target& target) const {
  Aims aims;
  for (const bool high : {false, true}) {
    double time = 0;
    std::optional<Shot> shot;
    for (int i = 0; i < 5; ++i) {
      const Vec3d place = target.position + time * (target.velocity + (0.5 * time) * target.acceleration);
      const Vec3d to = place - shooter.muzzle - time * shooter.velocity;
      const double range = math::hypot(to.x, to.z);
      const Entries entries = at(range, to.y);
      const std::optional<Entry>& entry = high ? entries.high : entries.low;
      shot.reset();
      if (!entry) break;
      const double c = math::cos(entry->elevation);
      shot = Shot{{c * to.x / range, math::sin(entry->elevation), c * to.z / range}, entry->time, place, {}};
      time = entry->time;
    }
    (high ? aims.high : aims.low) = shot;
  }
  if (!aims.low) aims.low = aims.high;
  if (!aims.high) aims.high = aims.low;
  return aims;
}

}  // namespace carom::ballistics
