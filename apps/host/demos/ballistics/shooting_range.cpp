// A marksman's range: zero, wind, sway, breath and recoil, and where the bullets go (chapters 18.2 to 18.5).
#include <algorithm>
#include <array>

#include "apps/host/demos/ballistics/range.h"
#include "carom/ballistics/dispersion.h"
#include "carom/ballistics/hits.h"
#include "carom/ballistics/sway.h"
#include "carom/ballistics/weapon.h"
#include "carom/math/random.h"

namespace carom::host::demo {
namespace {

using ballistics::BatchHits;
using rigid::Dim3;

constexpr double grain = 0.45359237 / 7000, foot = 0.3048, inch = 0.0254, yard = 0.9144;

/// What lies on the bench. Bullets, powder and guns as in the examples of the reference of free recoil and of the
/// makers.
struct Weapon {
  const char* name;
  ballistics::DragFunction drag;
  double coefficient, grains, calibre, speed, powder, gun_mass, sight;
};
constexpr Weapon weapons[] = {
    {".308, 168 gr", ballistics::DragFunction::g7, 0.218, 168, .308 * inch, 2650 * foot, 43.5 * grain, 3.63,
     1.5 * inch},
    {"5.56, 62 gr", ballistics::DragFunction::g7, 0.151, 62, .224 * inch, 3100 * foot, 26 * grain, 3.4, 2.6 * inch},
    {".22 rimfire, 40 gr", ballistics::DragFunction::ra4, 0.130, 40, .223 * inch, 1080 * foot, 2 * grain, 2.7,
     1.5 * inch},
    {"9 mm, 115 gr", ballistics::DragFunction::g1, 0.145, 115, .355 * inch, 1180 * foot, 6 * grain, 1.0, 0.6 * inch},
};

class ShootingRange final : public Repeatable<ShootingRange, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "shooting-range";
    d.title = "Shooting range";
    d.summary = "Zero the sights, read the wind, hold your breath, and look where the bullets went.";
    d.group = "Ballistics";
    d.chapter = "18.2 to 18.5";
    d.text =
        "The view is a telescope on the target; the cross is where the gun points. It sways with breath, heartbeat, "
        "tremor and the drift of the body, more when standing than when lying, and jumps with every shot:\n\n"
        "  V_gun = (m_b v_b + m_p v_gas)/M\n\n"
        "The bullet leaves where the gun points at that moment, flies with drag and wind by its own curve, and is "
        "swept against the bodies of the world. The sights are zeroed for one distance; at another it strikes high or "
        "low by what the range card says (grey cross) until clicks of the sight bring it up, low and aside when the "
        "gun leans, and downwind by w (T − T_vacuum). Half of the shots of a Gaussian spread lie within 1.1774 σ. The "
        "last plot asks how likely a steady gun hits a circle about the mark, by the derivatives of the flight where "
        "each shot has its own speed (σ 4 m/s) and cross wind (σ 1 m/s) beside the spread that is set, and shows what "
        "1000 flights, each computed, do. Behind the paper hangs a steel plate of 5 kg: the bullet pushes it, and it "
        "does not fly away.";
    d.dt = 1.0 / 120;
    d.duration = 24;
    d.camera = {{0, 1.5, 0}, {1, 1.5, 0}};
    d.parameters = {
        choice("weapon", "Weapon", "", {".308", "5.56", ".22", "9 mm pistol"}),
        {"distance", "Distance", "m", "m", "of the target", 25, 400, 5, 100, false},
        {"zero", "Zero of the sights", "m", "m", "", 25, 400, 5, 100, false},
        {"clicks_up", "Clicks up", "", "", "of a quarter minute of arc", -120, 120, 1, 0, false},
        {"clicks_right", "Clicks right", "", "", "", -120, 120, 1, 0, false},
        {"cant", "Cant", "rad", "deg", "the gun leaning to the right", -0.7, 0.7, 0, 0, false},
        {"wind", "Wind across", "m/s", "m/s", "from the left", -10, 10, 0.5, 2, false},
        choice("stance", "Stance", "", {"standing", "kneeling", "sitting", "lying", "with a rest"}, 3),
        {"skill", "Skill", "", "%", "", 0, 1, 0, 0.7, false},
        {"fatigue", "Fatigue", "", "%", "", 0, 1, 0, 0.1, false},
        {"spread", "Spread of gun and ammunition", "rad", "mrad", "σ of each axis", 0, 1e-3, 0, 1e-4, true},
        {"auto", "Shoots by itself", "s", "s", "between shots; 0: only you do", 0, 5, 0.1, 1.1, true},
    };
    d.plots = {{"Holes",
                {"right", "mm"},
                {"up", "mm"},
                {{"holes", Series::Style::points}, {"range card", Series::Style::points}}},
               {"Where the gun points", {"time", "s"}, {"angle", "mrad"}, {{"up"}, {"right"}}},
               {"Drop of the .308, zero 100 yd",
                {"distance", "yd"},
                {"height", "in"},
                {{"as here"}, {"reference solution", Series::Style::points}}},
               {"Hits in a circle",
                {"radius", "mm"},
                {"share of the shots", "%"},
                {{"probability"}, {"1000 flights", Series::Style::points}}}};
    d.inputs = {{"fire", "Fire", {"Space", "Enter"}, true, 1},
                {"breath", "Hold your breath", {"ShiftLeft", "ShiftRight"}, false, 1},
                {"right", "Right", {"ArrowRight", "KeyD"}, false, 1},
                {"left", "Left", {"ArrowLeft", "KeyA"}, false, 1},
                {"up", "Up", {"ArrowUp", "KeyW"}, false, 1},
                {"down", "Down", {"ArrowDown", "KeyS"}, false, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    const Weapon& w = weapons[stage.count("weapon")];
    distance_ = stage.value("distance");
    air_ = {.wind = environment::WindColumn(Vec3d{0, 0, stage.value("wind")})};
    const ballistics::Conditions world_air{.wind = environment::WindColumn(turned({0, 0, stage.value("wind")}))};
    gun_ = {.projectile = ballistics::projectile_from_coefficient(w.drag, w.coefficient),
            .mass = w.grains * grain,
            .muzzle_speed = w.speed,
            .sight_height = w.sight};
    ballistics::Conditions still = air_;
    still.wind = {};
    const auto zero = ballistics::zero_elevation(gun_, still, stage.value("zero"));
    if (!zero.ok()) return stage.fail(zero.error());
    aiming_ = ballistics::turned(ballistics::Aiming{.elevation = *zero, .cant = stage.value("cant")},
                                 {.click = 0.25 * ballistics::minute_of_angle}, stage.count("clicks_up"),
                                 stage.count("clicks_right"));
    auto card = ballistics::SightedFlight::fire(gun_, air_, aiming_, distance_ + 5);
    if (!card.ok()) return stage.fail(card.error());
    const auto point = card->at(distance_);
    if (!point) return stage.fail(core::Error{"the bullet does not get to the target"});
    card_ = {point->side, point->height};
    batch_ = ballistics::ProjectileBatch(gun_.projectile.drag, world_air, {});
    charge_ = {gun_.mass, w.speed, w.powder, 1585};
    mount_ = {.mass = w.gun_mass + 1.5,
              .inertia = w.gun_mass < 2 ? 0.05 : 0.9,
              .bore_above_shoulder = 0.03,
              .bore_beside_shoulder = 0.004,
              .rise_frequency = 1.8,
              .rise_damping = 0.8,
              .swing_frequency = 1.8,
              .swing_damping = 0.8};
    sway_ = ballistics::SwayMotion(
        ballistics::sway_of(ballistics::Stance(stage.count("stance")), stage.value("skill"), stage.value("fatigue")),
        7);
    area_ = pi / 4 * w.calibre * w.calibre;
    // Paper on a board, half a metre square or larger where the spread asks for it.
    half_ = max(0.25, 1.2 * max(abs(card_.x), abs(card_.y)));
    half_ = min(max(half_, 1.6e-3 * distance_), 3.0);
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "target";
    body.position = turned({distance_ + 0.01, eye_, 0});
    rigid::ShapeDef<Dim3> paper;
    paper.material.user_id = paper_;
    stage.add(body, geometry::Box{{0.01f, float(half_), float(half_)}}, paper, 0xf2efe4);
    body.name = "earth wall";
    body.position = turned({distance_ + 3, eye_ - 0.2, 0});
    rigid::ShapeDef<Dim3> earth;
    earth.material.user_id = earth_;
    stage.add(body, geometry::Box{{0.5f, float(2.2 * half_), float(3.2 * half_)}}, earth, 0x6f5f45);
    body.type = rigid::BodyType::dynamic;
    body.name = "plate";
    const double plate = min(0.16, 0.5 * half_);
    body.position = turned({distance_ + 0.6, eye_, 0});
    rigid::ShapeDef<Dim3> steel_plate;
    steel_plate.material.user_id = steel_;
    steel_plate.density = float(5 / (8 * 0.006 * plate * plate));
    plate_ = stage.add(body, geometry::Box{{0.006f, float(plate), float(plate)}}, steel_plate, steel);
    for (const double side : {-1.0, 1.0}) {
      rigid::DistanceJointDef<Dim3> chain;
      chain.body_b = plate_;
      chain.frame_a.p = {-float(distance_ + 0.6), float(eye_ + plate + 0.4), float(side * plate)};
      chain.frame_b.p = {0, float(plate), float(side * plate)};
      chain.length = 0.4f;
      (void)stage.keep(stage.world().create_joint(chain));
    }
    const ballistics::Layer board{.thickness = 0.02, .medium = {2e6, 300}};
    const ballistics::Layer armour{.thickness = 0.012, .limit_speed = 1200};
    const ballistics::Layer soil{.thickness = BatchHits<Dim3>::through, .medium = {4e6, 1500}};
    stage.check(hits_.set_material(paper_, std::span(&board, 1)));
    stage.check(hits_.set_material(steel_, std::span(&armour, 1)));
    stage.check(hits_.set_material(earth_, std::span(&soil, 1)));
    stage.set_camera(
        {turned({distance_ - 4.2 * half_, eye_ + 0.25 * half_, 0.5 * half_}), turned({distance_, eye_, 0}), 0.6});
    stage.sample(0, 1, 1000 * card_.x, 1000 * card_.y);
    for (int i = 0; i <= 40; ++i)
      if (const auto there = reference_drop(25.0 * i)) stage.sample(2, 0, 25.0 * i, *there);
    for (const auto& [yards, inches] : drops_) stage.sample(2, 1, yards, inches);
    count_hits(stage);
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time(), dt = stage.declaration().dt, swing = 2e-3 * dt;
    held_ = clamp(held_ + (stage.input("breath") > 0 ? 2 : -1.5) * dt, 0.0, 1.0);
    aim_.x += swing * (stage.input("right") - stage.input("left"));
    aim_.y += swing * (stage.input("up") - stage.input("down"));
    const double interval = stage.value("auto");
    bool shoot = stage.presses("fire") > 0;
    if (interval > 0 && t >= next_) {
      shoot = true;
      next_ = t + interval;
    }
    if (shoot) fire(stage, t);
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status s = stage.world().step(float(dt)); !s.ok()) return s;
    batch_.step(dt);
    return hits_.collect(batch_, stage.world(), dt);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (const ballistics::BatchHit& hit : hits_.hits()) {
      if (hit.material == paper_ && hit.normal.x > 0.5) {
        const Vec2d hole{-hit.point.z, hit.point.y - eye_};
        holes_.push_back({Vec3f{float(hit.point.x + 0.002), float(hit.point.y), float(hit.point.z)}});
        stage.sample(0, 0, 1000 * hole.x, 1000 * hole.y);
        if (holes_.size() > 400) holes_.erase(holes_.begin());
        sum_ += hole - fired_[std::size_t(hit.tag) % fired_.size()];
        ++count_;
        last_ = hole;
        told_ = gun_.mass > 0 ? length(hit.velocity) : 0;
      }
    }
    rings(stage);
    if (!holes_.empty()) stage.points(holes_, float(max(0.005, 0.018 * half_)), pen(0x181410));
    const Vec2d now = pointing(t);
    cross_at(stage, distance_ * now, red, 0.12);
    cross_at(stage, card_, steel, 0.05);
    stage.sample(1, 0, t, 1000 * now.y);
    stage.sample(1, 1, t, 1000 * now.x);
    stage.say(count_ == 0
                  ? std::string("take aim")
                  : format("%.0f holes; the last one ", double(count_)) + format("%.0f mm ", 1000 * abs(last_.x)) +
                        (last_.x < 0 ? "left, " : "right, ") + format("%.0f mm ", 1000 * abs(last_.y)) +
                        (last_.y < 0 ? "low, " : "high, ") + format("at %.0f m/s", told_) +
                        format("; a steady gun hits the smallest ring with %.0f %%", 100 * smallest_));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    // Each hole less where the gun pointed when it was fired: what the range card says, whatever the sway.
    const double n = max(count_, 1);
    out.push_back({"greatest difference of shares and probabilities", "",
                   "Kolmogorov and Smirnov: 1.63/√n, missed once in a hundred", unlike_, 0,
                   1.63 / sqrt(double(flights_))});
    out.push_back({"holes in the paper", "", "one each 1.1 s", double(count_ >= 20), 1, 0});
    out.push_back({"height of the strike", "mm", "the range card of the load", 1000 * sum_.y / n, 1000 * card_.y, 1});
    out.push_back({"wind drift", "mm", "the range card: w (T − T_vacuum)", 1000 * sum_.x / n, 1000 * card_.x, 1});
    for (const auto& [yards, inches] : drops_)
      out.push_back({format("drop of the .308 at %.0f yd", yards), "in", "reference integration, zero 100 yd",
                     reference_drop(yards).value_or(0), inches, 1e-3 * abs(inches)});
  }

 private:
  static constexpr double eye_ = 1.5, ring_ = 0.22;  // of half the paper
  static constexpr int flights_ = 1000;
  static constexpr std::uint32_t paper_ = 0xff000001, steel_ = 0xff000002, earth_ = 0xff000003;

  /// in at so many yd: the 168-grain .308 (G7 .218, 2 650 ft/s, sight 1.5 in, zero 100 yd) at 1.225 kg/m³, the drag
  /// table's nodes joined by lines; an independent integration.
  static constexpr std::pair<double, double> drops_[] = {
      {200, -4.333}, {300, -15.565}, {500, -64.287}, {800, -234.960}, {1000, -455.581}};
  std::optional<double> reference_drop(double yards) {
    if (!reference_) {
      const ballistics::Gun smk{.projectile = ballistics::projectile_from_coefficient(
                                    ballistics::DragFunction::g7, .218, ballistics::Interpolation::linear),
                                .muzzle_speed = 2650 * foot,
                                .sight_height = 1.5 * inch};
      const ballistics::Conditions standard{.air = environment::AirColumn::uniform(1.225)};
      const auto zero = ballistics::zero_elevation(smk, standard, 100 * yard);
      auto flight = ballistics::SightedFlight::fire(smk, standard, {.elevation = zero.ok() ? *zero : 0}, 1001 * yard);
      if (!flight.ok()) return std::nullopt;
      reference_ = std::move(flight).value();
    }
    const auto at = reference_->at(yards * yard);
    return at ? std::optional<double>(at->height / inch) : std::nullopt;
  }

  /// The shooter's frame (x down range, z to the right) as it lies in the world: the light falls on the paper.
  static constexpr Vec3d turned(Vec3d v) { return {-v.x, v.y, -v.z}; }

  /// rad, where the gun points: x to the right, y up.
  Vec2d pointing(double t) const {
    const ballistics::RecoilMotion kick = ballistics::recoil_at(mount_, ballistics::recoil_impulse(charge_), shots_, t);
    return aim_ + sway_.at(t, held_) + Vec2d{kick.swing, kick.rise};
  }

  void fire(Stage3& stage, double t) {
    const double sigma = stage.value("spread");
    const Vec2d at = pointing(t) + sigma * Vec2d{random_.normal(), random_.normal()};
    const Vec3d line = ballistics::swung({1, 0, 0}, at.y, at.x);
    const Vec3d u = gun_.muzzle_speed * ballistics::bore_direction(line, aiming_);
    const math::SinCos<double> cant = math::sincos(aiming_.cant);
    const Vec3d muzzle{0, eye_ - gun_.sight_height * cant.cos, -gun_.sight_height * cant.sin};
    fired_[shot_ % fired_.size()] = distance_ * at;
    batch_.add(
        {turned(muzzle), turned(u)},
        {.area_per_mass = gun_.projectile.area_per_mass, .mass = gun_.mass, .frontal_area = area_, .tag = shot_});
    ++shot_;
    shots_.push_back(t);
    if (shots_.size() > 8) shots_.erase(shots_.begin());
  }

  /// How likely a steady gun hits circles about the mark, and how many of so many flights do.
  void count_hits(Stage3& stage) {
    const ballistics::ShotVariation varies{.muzzle_speed = 4, .wind = 1, .aim = stage.value("spread")};
    const auto spread = ballistics::spread_at(gun_, air_, aiming_, distance_, varies);
    if (!spread.ok()) return stage.fail(spread.error());
    smallest_ = ballistics::hit_probability(*spread, ring_ * half_);
    std::vector<double> off;
    math::Random random{5};
    for (int i = 0; i < flights_; ++i) {
      ballistics::Gun gun = gun_;
      ballistics::Aiming aiming = aiming_;
      gun.muzzle_speed += varies.muzzle_speed * random.normal();
      aiming.elevation += varies.aim * random.normal();
      aiming.windage += varies.aim * random.normal();
      const double wind = stage.value("wind") + varies.wind * random.normal();
      auto flight = ballistics::SightedFlight::fire(gun, {.wind = environment::WindColumn(Vec3d{0, 0, wind})}, aiming,
                                                    distance_ + 1);
      if (!flight.ok()) return stage.fail(flight.error());
      const auto point = flight->at(distance_);
      off.push_back(point ? hypot(point->side, point->height) : 1e300);
    }
    const double widest = length(spread->mean) + 3 * max(spread->sigma.x, spread->sigma.y);
    unlike_ = 0;
    for (int i = 1; i <= 24; ++i) {
      const double radius = widest * i / 24, likely = ballistics::hit_probability(*spread, radius);
      const double share =
          double(std::count_if(off.begin(), off.end(), [&](double o) { return o <= radius; })) / flights_;
      unlike_ = max(unlike_, abs(share - likely));
      stage.sample(3, 0, 1000 * radius, 100 * likely);
      if (i % 2 == 0) stage.sample(3, 1, 1000 * radius, 100 * share);
    }
  }

  void rings(Stage3& stage) const {
    for (int r = 1; r <= 4; ++r)
      for (int i = 0; i < 48; ++i) {
        const double radius = ring_ * half_ * r, a = 2 * pi * i / 48, b = 2 * pi * (i + 1) / 48;
        mark(stage, radius * Vec2d{cos(a), sin(a)}, radius * Vec2d{cos(b), sin(b)}, dark);
      }
  }
  void cross_at(Stage3& stage, Vec2d p, std::uint32_t color, double share) const {
    const double s = share * half_;
    mark(stage, p - Vec2d{0, s}, p + Vec2d{0, s}, color);
    mark(stage, p - Vec2d{s, 0}, p + Vec2d{s, 0}, color);
  }
  /// A line a little before the paper.
  void mark(Stage3& stage, Vec2d a, Vec2d b, std::uint32_t color) const {
    const double x = distance_ - 0.005;
    stage.line(turned({x, eye_ + a.y, a.x}), turned({x, eye_ + b.y, b.x}), pen(color));
  }

  ballistics::Gun gun_{};
  ballistics::Aiming aiming_{};
  ballistics::Conditions air_{};
  ballistics::Charge charge_{};
  ballistics::GunMount mount_{};
  ballistics::SwayMotion sway_{{}, 7};
  ballistics::ProjectileBatch batch_{ballistics::DragCurve(0.3), {}};
  BatchHits<Dim3> hits_;
  std::optional<ballistics::SightedFlight> reference_;
  math::Random random_{11};
  rigid::BodyId plate_;
  std::vector<Vec3f> holes_;
  std::vector<double> shots_;
  std::array<Vec2d, 64> fired_{};
  Vec2d aim_{}, card_{}, sum_{}, last_{};
  double distance_ = 100, half_ = 0.25, held_ = 0, next_ = 0.7, area_ = 0, told_ = 0, smallest_ = 0, unlike_ = 0;
  std::uint64_t shot_ = 0;
  int count_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_shooting_range() { return std::make_unique<ShootingRange>(); }

}  // namespace carom::host::demo
