#include "carom/scene/detail/ball_release.h"

#include "carom/math/elementary.h"
#include "carom/scene/detail/joint_fields.h"
#include "carom/sports/game_presets.h"
#include "carom/sports/golf_impact.h"

namespace carom::scene::detail {
namespace {
using math::Vec3d;
using T = FieldType;
using M = Measure;

constexpr const char* from_text = "on the ground: the middle of the bowler's crease, or of the pitcher's rubber";
constexpr const char* toward_text = "level: what counts as straight on; x unless given";

constexpr Field bowled_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"speed", T::quantity, M::speed},
    {"elevation", T::quantity, M::angle, "unless it is aimed"},
    {"azimuth", T::quantity, M::angle, "to the right, unless it is aimed"},
    {"spin", T::quantity, M::angular_speed, "across the way"},
    {"tilt", T::quantity, M::angle, "0 backspin, 180 deg topspin, positive between them curves to the right"},
    {"gyro", T::quantity, M::angular_speed, "about the way, right-handed: turns to the right off the pitch"},
    {"seam", T::quantity, M::angle, "to the right of the way"},
    {"height", T::quantity, M::length, "of the ball as it leaves the hand"},
    {"side", T::quantity, M::length, "to the right of from"},
    {"from", T::vector, M::length, from_text},
    {"toward", T::vector, M::plain, toward_text},
    {"at", T::vector, M::length, "aimed so that it pitches at this point of the ground"},
};
constexpr Field pitched_fields[] = {
    {"preset", T::text, M::plain, preset_text},
    {"description", T::text},
    {"speed", T::quantity, M::speed},
    {"elevation", T::quantity, M::angle, "unless it is aimed"},
    {"azimuth", T::quantity, M::angle, "to the right, unless it is aimed"},
    {"spin", T::quantity, M::angular_speed, "across the way"},
    {"tilt", T::quantity, M::angle, "0 backspin, 180 deg topspin, positive between them curves to the right"},
    {"gyro", T::quantity, M::angular_speed, "about the way"},
    {"release_height", T::quantity, M::length},
    {"release_side", T::quantity, M::length, "to the right of from"},
    {"from", T::vector, M::length, from_text},
    {"toward", T::vector, M::plain, toward_text},
    {"at", T::vector, M::length, "aimed so that its centre comes through this point"},
};
constexpr Field golf_shot_fields[] = {
    {"description", T::text},
    {"club", T::text, M::plain, "driver, 3-wood, 5-wood, hybrid, 3-iron to 9-iron, wedge", nullptr, {}, true},
    {"speed", T::quantity, M::speed,
     "of the head; this and what follows as tour players deliver the club unless given"},
    {"attack", T::quantity, M::angle, "upward"},
    {"path", T::quantity, M::angle, "of the head, to the right"},
    {"face", T::quantity, M::angle, "where it looks, to the right"},
    {"lean", T::quantity, M::angle, "dynamic loft less static"},
    {"toe", T::quantity, M::length, "where the ball is met, from the sweet spot toward the toe"},
    {"high", T::quantity, M::length, "and up the face"},
    {"toward", T::vector, M::plain, toward_text},
};

/// x straight on, y up, z to the right.
struct ThrowFrame {
  Vec3d forward{1, 0, 0}, right{0, 0, 1};
  Vec3d to_world(Vec3d v) const { return v.x * forward + Vec3d{0, v.y, 0} + v.z * right; }
  Vec3d to_frame(Vec3d v) const { return {dot(v, forward), v.y, dot(v, right)}; }
};
ThrowFrame read_throw_frame(Reader& reader, const Object& o) {
  ThrowFrame frame;
  const Vec3d toward = reader.vector(o, "toward", {1, 0, 0});
  const double level = math::hypot(toward.x, toward.z);
  if (!reader.failed() && !(level > 1e-9))
    reader.expected(*o.find("toward"), o.path_of("toward"), "a direction that is not upright");
  if (reader.failed()) return frame;
  frame.forward = {toward.x / level, 0, toward.z / level};
  frame.right = {0.0 - frame.forward.z, 0, frame.forward.x};
  return frame;
}

/// What "at" is from "from", in the frame; empty where it is not aimed.
std::optional<Vec3d> read_target(Reader& reader, const Object& o, const ThrowFrame& frame, Vec3d from) {
  if (!o.has("at")) return {};
  const Vec3d target = frame.to_frame(reader.vector(o, "at") - from);
  if (!reader.failed() && !(target.x > 0.1 && target.x < 1000))
    reader.expected(*o.find("at"), o.path_of("at"), "a point in front of from, 0.1 m to 1 km away");
  return target;
}

template <class Thrown>
std::optional<Thrown> read_thrown(Reader& reader, const Object& o) {
  std::vector<sports::Number> numbers;
  for (const sports::NumberName& number : sports::game_number_names<Thrown>())
    if (o.has(number.name)) numbers.push_back({number.name, reader.number(o, number.name, 0)});
  if (reader.failed()) return {};
  auto thrown = sports::game_from_numbers<Thrown>(numbers);
  if (!reader.accept(thrown ? core::Status{} : core::Status{thrown.error()}, *o.node, o.path)) return {};
  return *thrown;
}

/// Deliveries and pitches name how a ball leaves the hand alike.
template <class Thrown>
sports::Launch out_of_the_hand(const Thrown& t) {
  return {
      .speed = t.speed, .elevation = t.elevation, .azimuth = t.azimuth, .spin = t.spin, .tilt = t.tilt, .gyro = t.gyro};
}

sports::Conditions in_frame(sports::Conditions conditions, const ThrowFrame& frame) {
  conditions.wind = environment::WindColumn(frame.to_frame(conditions.wind.at(0)));
  return conditions;
}

BallRelease released(const ThrowFrame& frame, Vec3d from, const sports::Launch& launch, Vec3d position) {
  const sports::BallState start = sports::launch_state(launch, position);
  BallRelease release;
  release.position = from + frame.to_world(start.position);
  release.velocity = frame.to_world(start.velocity);
  release.spin = frame.to_world(start.spin);
  return release;
}

std::optional<BallRelease> read_delivery(Reader& reader, const Object& o, const sports::Ball& ball,
                                         const sports::Conditions& conditions) {
  const ThrowFrame frame = read_throw_frame(reader, o);
  const Vec3d from = reader.vector(o, "from");
  auto d = read_thrown<sports::CricketDelivery>(reader, o);
  const std::optional<Vec3d> target = read_target(reader, o, frame, from);
  if (reader.failed()) return {};
  if (target) {
    // The ground is where it pitches; a metre farther on it need only arrive.
    const double up = target->y;
    d->height -= up;
    const auto aimed = sports::aimed(ball, in_frame(conditions, frame), *sports::surface_preset("pitch"), *d, 1,
                                     target->z, target->x + 1);
    if (!reader.accept(aimed ? core::Status{} : core::Status{aimed.error()}, *o.node, o.path)) return {};
    d = *aimed;
    d->height += up;
  }
  BallRelease release = released(frame, from, out_of_the_hand(*d), {0, d->height, d->side});
  const math::SinCos<double> seam = math::sincos(d->azimuth + d->seam);
  release.seam_normal = frame.to_world({0.0 - seam.sin, 0, seam.cos});
  return release;
}

std::optional<BallRelease> read_pitch(Reader& reader, const Object& o, const sports::Ball& ball,
                                      const sports::Conditions& conditions) {
  const ThrowFrame frame = read_throw_frame(reader, o);
  const Vec3d from = reader.vector(o, "from");
  auto p = read_thrown<sports::Pitch>(reader, o);
  const std::optional<Vec3d> target = read_target(reader, o, frame, from);
  if (reader.failed()) return {};
  if (target) {
    const auto aimed = sports::aimed(ball, in_frame(conditions, frame), *p, target->y, target->z, target->x);
    if (!reader.accept(aimed ? core::Status{} : core::Status{aimed.error()}, *o.node, o.path)) return {};
    p = *aimed;
  }
  return released(frame, from, out_of_the_hand(*p), p->release);
}

std::optional<BallRelease> read_shot(Reader& reader, const Object& o, const sports::Ball& ball) {
  const ThrowFrame frame = read_throw_frame(reader, o);
  const auto club = sports::club_preset(reader.text(o, "club"));
  if (reader.failed() ||
      !reader.accept(club ? core::Status{} : core::Status{club.error()}, *o.find("club"), o.path_of("club")))
    return {};
  sports::ClubDelivery d = club->delivery;
  d.speed = reader.number(o, "speed", d.speed);
  d.attack = reader.number(o, "attack", d.attack);
  d.path = reader.number(o, "path", d.path);
  d.face = reader.number(o, "face", d.face);
  d.lean = reader.number(o, "lean", d.lean);
  d.toe = reader.number(o, "toe", d.toe);
  d.high = reader.number(o, "high", d.high);
  if (reader.failed()) return {};
  const auto impact = sports::strike(ball, club->head, d);
  if (!reader.accept(impact ? core::Status{} : core::Status{impact.error()}, *o.node, o.path)) return {};
  BallRelease release;
  release.velocity = frame.to_world(impact->ball.velocity);
  release.spin = frame.to_world(impact->ball.spin);
  return release;
}

}  // namespace

const ObjectKind bowled_kind{"cricket_delivery", "How a cricket ball is bowled, as in presets/cricket.", bowled_fields};
const ObjectKind pitched_kind{"baseball_pitch", "How a baseball is pitched, as in presets/pitch.", pitched_fields};
const ObjectKind golf_shot_kind{"golf_shot", "How a golf ball is struck.", golf_shot_fields};

std::optional<BallRelease> read_ball_release(Reader& reader, const Object& effector, const sports::Ball& ball,
                                             const sports::Conditions& conditions) {
  const char* given = nullptr;
  for (const char* key : {"delivery", "pitch", "shot"}) {
    if (!effector.has(key)) continue;
    if (given != nullptr) {
      reader.fail(*effector.find(key), effector.path_of(key),
                  "found both " + std::string(given) + " and " + key + ", expected one of delivery, pitch and shot");
      return {};
    }
    given = key;
  }
  if (given == nullptr || reader.failed()) return {};
  const std::string_view key = given;
  Object o;
  if (!reader.open(*effector.find(key), effector.path_of(key),
                   key == "delivery" ? bowled_kind : (key == "pitch" ? pitched_kind : golf_shot_kind), o))
    return {};
  if (key == "delivery") return read_delivery(reader, o, ball, conditions);
  if (key == "pitch") return read_pitch(reader, o, ball, conditions);
  return read_shot(reader, o, ball);
}

}  // namespace carom::scene::detail
