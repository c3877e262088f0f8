#include "carom/ballistics/motor.h"

#include <algorithm>
#include <optional>

#include "carom/core/string.h"
#include "carom/math/decimal.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

core::Result<ThrustCurve> ThrustCurve::from_points(std::vector<ThrustPoint> points) {
  if (points.empty()) return core::Error{"a thrust curve has no points, expected at least one"};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ThrustPoint& p = points[i];
    const std::string where = core::text("point ", i + 1, " of a thrust curve: ");
    if (!math::is_finite(p.time) || p.time < 0)
      return core::Error{where + core::refused("time", p.time, "a finite number of seconds >= 0")};
    if (!math::is_finite(p.thrust) || p.thrust < 0)
      return core::Error{where + core::refused("thrust", p.thrust, "a finite number of newtons >= 0")};
    if (i > 0 && !(p.time > points[i - 1].time))
      return core::Error{where +
                         core::refused("time", p.time, core::text("more than the ", points[i - 1].time, " before"))};
  }
  if (points.front().time > 0) points.insert(points.begin(), {0, 0});
  ThrustCurve curve;
  curve.points_ = std::move(points);
  curve.impulses_.push_back(0);
  for (std::size_t i = 1; i < curve.points_.size(); ++i) {
    const ThrustPoint &a = curve.points_[i - 1], &b = curve.points_[i];
    curve.impulses_.push_back(curve.impulses_.back() + 0.5 * (a.thrust + b.thrust) * (b.time - a.time));
  }
  if (!math::is_finite(curve.impulses_.back()))
    return core::Error{"a thrust curve's impulse is beyond what a number holds"};
  return curve;
}

ThrustCurve ThrustCurve::constant(double thrust, double duration) {
  ThrustCurve curve;
  curve.points_ = {{0, thrust}, {duration, thrust}};
  curve.impulses_ = {0, thrust * duration};
  return curve;
}

std::size_t ThrustCurve::interval(double time) const {
  const auto after =
      std::upper_bound(points_.begin(), points_.end(), time, [](double t, const ThrustPoint& p) { return t < p.time; });
  return std::size_t(math::max<std::ptrdiff_t>(after - points_.begin(), 1)) - 1;
}

double ThrustCurve::thrust(double time) const {
  if (points_.empty() || time < 0 || time > points_.back().time) return 0;
  const std::size_t i = math::min(interval(time), points_.size() - 1);
  if (i + 1 == points_.size()) return points_[i].thrust;
  const ThrustPoint &a = points_[i], &b = points_[i + 1];
  return a.thrust + (time - a.time) / (b.time - a.time) * (b.thrust - a.thrust);
}

double ThrustCurve::impulse(double time) const {
  if (points_.empty() || !(time > 0)) return 0;
  if (time >= points_.back().time) return impulses_.back();
  const std::size_t i = interval(time);
  return impulses_[i] + 0.5 * (points_[i].thrust + thrust(time)) * (time - points_[i].time);
}

std::string impulse_class(double total_impulse) {
  if (!(total_impulse > 0)) return "none";
  if (total_impulse <= 0.625) return "1/4A";
  if (total_impulse <= 1.25) return "1/2A";
  double limit = 2.5;
  char letter = 'A';
  while (total_impulse > limit && letter < 'Z') {
    limit *= 2;
    ++letter;
  }
  return std::string(1, letter);
}

namespace detail {

/// Words of a line, without what follows ';'.
std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, math::min(line.find(';'), line.size()));
  std::vector<std::string_view> words;
  std::size_t i = 0;
  const auto space = [&](std::size_t k) { return line[k] == ' ' || line[k] == '\t' || line[k] == '\r'; };
  while (i < line.size()) {
    while (i < line.size() && space(i)) ++i;
    const std::size_t start = i;
    while (i < line.size() && !space(i)) ++i;
    if (i > start) words.push_back(line.substr(start, i - start));
  }
  return words;
}

std::optional<double> number_of(std::string_view word) {
  const math::DecimalResult parsed = math::parse_decimal(word);
  if (word.empty() || parsed.length != word.size() || !math::is_finite(parsed.value)) return std::nullopt;
  return parsed.value;
}

}  // namespace detail

core::Result<std::vector<Motor>> read_rasp(std::string_view text, std::string_view name) {
  std::vector<Motor> motors;
  std::vector<ThrustPoint> points;
  bool in_motor = false;
  int number = 0, header = 0;
  const auto error = [&](int line, std::string_view found, std::string_view expected) {
    return core::Error{core::text(name, ":", line, ": found ", found, ", expected ", expected)};
  };
  const auto finish = [&]() -> core::Result<void> {
    core::Result<ThrustCurve> curve = ThrustCurve::from_points(std::move(points));
    points.clear();
    in_motor = false;
    if (!curve)
      return core::Error{core::text(name, ":", header, ": motor ", motors.back().name, ": ", curve.error().message)};
    motors.back().curve = std::move(curve).value();
    return {};
  };
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // a byte order mark, as some editors write it
  while (!text.empty()) {
    ++number;
    const std::size_t end = math::min(text.find('\n'), text.size());
    const std::vector<std::string_view> words = detail::words_of(text.substr(0, end));
    text.remove_prefix(math::min(end + 1, text.size()));
    if (words.empty()) continue;
    // A thrust of 0 ends a motor, but measured curves touch it between, too: what follows tells.
    const bool ended = in_motor && points.size() > 1 && points.back().thrust == 0;
    if (ended && words.size() != 2)
      if (const core::Result<void> done = finish(); !done.ok()) return done.error();
    if (!in_motor) {
      if (words.size() < 7)
        return error(number, core::text(words.size(), " words"),
                     "the header of a motor: name, diameter, length, delays, propellant mass, mass, manufacturer");
      Motor motor;
      motor.name = words[0];
      motor.manufacturer = words[6];
      for (std::size_t i = 7; i < words.size(); ++i) {  // some makers have names of several words
        motor.manufacturer += ' ';
        motor.manufacturer += words[i];
      }
      const struct {
        std::size_t word;
        const char* what;
        double* to;
        double scale;
      } fields[] = {{1, "a diameter in mm > 0", &motor.diameter, 1e-3},
                    {2, "a length in mm > 0", &motor.length, 1e-3},
                    {4, "a propellant mass in kg > 0", &motor.propellant_mass, 1},
                    {5, "a mass in kg > 0", &motor.mass, 1}};
      for (const auto& field : fields) {
        const std::optional<double> value = detail::number_of(words[field.word]);
        if (!value || !(*value > 0)) return error(number, core::quoted(words[field.word]), field.what);
        *field.to = *value * field.scale;
      }
      if (motor.propellant_mass > motor.mass)
        return error(number, core::text(motor.propellant_mass, " kg of propellant"),
                     core::text("at most the motor's mass of ", motor.mass, " kg"));
      std::string_view delays = words[3];
      while (!delays.empty()) {
        const std::size_t dash = math::min(delays.find_first_of("-,"), delays.size());
        const std::string_view delay = delays.substr(0, dash);
        delays.remove_prefix(math::min(dash + 1, delays.size()));
        if (delay == "P" || delay == "p") {
          motor.plugged = true;
          continue;
        }
        const std::optional<double> value = detail::number_of(delay);
        if (!value || *value < 0)
          return error(number, core::quoted(delay), "delays in s separated by dashes, or P for plugged");
        motor.delays.push_back(*value);
      }
      motors.push_back(std::move(motor));
      in_motor = true;
      header = number;
      continue;
    }
    const std::optional<double> time = detail::number_of(words[0]);
    const std::optional<double> thrust = words.size() == 2 ? detail::number_of(words[1]) : std::nullopt;
    if (!time || !thrust)
      return error(number, core::quoted(words.size() == 2 && time ? words[1] : words[0]),
                   "a time in s and a thrust in N");
    if (*time < 0 || (!points.empty() && !(*time > points.back().time)))
      return error(number, core::text("the time ", *time), "times that rise from 0");
    if (*thrust < 0) return error(number, core::text("the thrust ", *thrust), "a thrust >= 0");
    points.push_back({*time, *thrust});
  }
  if (in_motor && !(points.size() > 1 && points.back().thrust == 0))
    return error(number, "the end of the file", "the motor's last line, with thrust 0");
  if (in_motor)
    if (const core::Result<void> done = finish(); !done.ok()) return done.error();
  if (motors.empty()) return error(number, "no motor", "at least one");
  return motors;
}

}  // namespace carom::ballistics
