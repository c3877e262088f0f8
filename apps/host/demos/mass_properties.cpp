// A car, its driver and its tank: where the centre of gravity is and how hard the whole is to turn (chapter 1.6, 1.8).
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

/// The chapter's axes (x forward, z up) to the world's (x forward, y up).
Vec3d to_world(Vec3d p) { return {p.x, p.z, -p.y}; }
Vec3d from_world(Vec3d p) { return {p.x, -p.z, p.y}; }

struct Part {
  const char *name, *mass, *x, *y, *z;
  Vec3d size;
  std::uint32_t color;
};
constexpr Part parts[] = {
    {"car", "car_mass", "car_x", nullptr, nullptr, {4.0, 1.8, 1.2}, blue},
    {"driver", "driver_mass", "driver_x", "driver_y", "driver_z", {0.4, 0.5, 0.9}, orange},
    {"fuel tank", "fuel_mass", "fuel_x", nullptr, nullptr, {0.5, 0.9, 0.3}, green},
};

class CompositeMass final : public Repeatable<CompositeMass, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "mass-properties";
    d.title = "Car, driver, fuel: mass properties";
    d.summary = "Move the driver and fill the tank: the centre of gravity and the principal axes follow.";
    d.group = "Mass";
    d.chapter = "1.6, 1.8";
    d.text =
        "A body of several parts turns about one point, its centre of gravity, and resists turning by its inertia "
        "tensor.\n\n"
        "  r = Σ mᵢ rᵢ / Σ mᵢ      I = Σ (Iᵢ + mᵢ (|dᵢ|² E − dᵢ dᵢᵀ))\n\n"
        "The lines are the principal axes, the directions about which the body spins without wobbling; each is as long "
        "as the "
        "body's radius of gyration about it. The whole floats freely: grab a corner and it turns about the mark, "
        "wherever you "
        "pull. Axes as in the chapter: x forward, y to port, z up, from the rear of the floor.";
    d.duration = 4;
    d.camera = {{5.6, 3.4, 5.2}, {2, 0.7, 0}};
    d.ground = 0;
    d.parameters = {
        {"car_mass", "Mass of the car", "kg", "kg", "a box of 4.0 × 1.8 × 1.2 m", 100, 4000, 10, 1500, false},
        {"driver_mass", "Mass of the driver", "kg", "kg", "a box of 0.4 × 0.5 × 0.9 m", 1, 1000, 1, 80, false},
        {"fuel_mass", "Mass of the fuel", "kg", "kg", "a box of 0.5 × 0.9 × 0.3 m", 1, 1000, 1, 50, false},
        {"car_x", "Car: forward", "m", "m", "", 0, 4, 0.05, 2, false},
        {"driver_x", "Driver: forward", "m", "m", "", 0.2, 3.8, 0.05, 2.2, false},
        {"driver_y", "Driver: to port", "m", "m", "", -1.5, 1.5, 0.05, 0.4, false},
        {"driver_z", "Driver: up", "m", "m", "", 0.3, 3, 0.05, 0.8, false},
        {"fuel_x", "Tank: forward", "m", "m", "", 0.2, 3.8, 0.05, 0.8, false},
    };
    d.plots = {{"Centre of gravity while the tank fills",
                {"mass of the fuel", "kg"},
                {"forward of the rear", "m"},
                {{"by the formula"}, {"now", Series::Style::points}}},
               {"Yaw inertia as the driver moves",
                {"driver, forward", "m"},
                {"I_zz", "kg·m²"},
                {{"by the formula"}, {"now", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.gravity = {};
    stage.start(world);
    stage.looks_in_materials = true;
    rigid::BodyDef<Dim3> body;
    body.name = "car, driver and tank";
    body.position = {0, 0.35, 0};
    body.sleep_speed = 0;
    body.angular_damping = 0.15f;
    body.linear_damping = 0.3f;
    const auto part = [&](int i) {
      rigid::ShapeDef<Dim3> shape;
      shape.local.p = Vec3f(to_world(center(stage, i)));
      shape.density = float(stage.value(parts[i].mass) / (parts[i].size.x * parts[i].size.y * parts[i].size.z));
      // The car is glass, so that one sees what sits in it.
      shape.material.user_id = (i == 0 ? 0x50000000u : 0xff000000u) | parts[i].color;
      const Vec3d half = 0.5 * parts[i].size;
      return Stage3::Part{geometry::Box{Vec3f(Vec3d{half.x, half.z, half.y})}, shape};
    };
    body_ = stage.add(body, {part(0), part(1), part(2)}, blue);
    properties_ = stage.keep(stage.world().mass_properties3(body_));
    curves(stage);
    const Vec3d c = from_world(properties_.center);
    const Mat3d& i = properties_.inertia;
    stage.say(format("m = %.0f kg, CG = (%.5f, %.5f, %.5f) m", properties_.mass, c.x, c.y, c.z) +
              format(", I = %.3f, %.3f, %.3f kg·m²", i.cx.x, i.cz.z, i.cy.y));
  }

  void after_step(Stage3& stage) override {
    const auto state = stage.at(body_);
    const geometry::PrincipalAxes axes = geometry::principal_axes(properties_.inertia);
    const std::uint32_t pens[] = {pen(red), pen(green), pen(gold)};
    for (int k = 0; k < 3; ++k) {
      Vec3d unit{};
      unit[k] = 1;
      const Vec3d local = rotate(axes.rotation, unit) * math::sqrt(axes.moments[k] / properties_.mass);
      const Vec3d way = 2.2 * Vec3d(rotate(state.pose.rotation, Vec3f(local)));
      stage.line(state.center_of_mass - way, state.center_of_mass + way, pens[k]);
    }
    // The mark: three circles about the centre of gravity.
    for (int k = 0; k < 3; ++k) ring(stage, state.center_of_mass, 0.16, k);
    wireframes(stage, state.pose);
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const Vec3d c = from_world(properties_.center);
    const Mat3d& i = properties_.inertia;
    const Vec3d m = geometry::principal_axes(i).moments;
    const char* source = "ch. 1.6, composite of three boxes";
    out.push_back({"mass", "kg", source, properties_.mass, 1630, 1e-2});
    out.push_back({"CG x", "m", source, c.x, 1.97301, 1e-5});
    out.push_back({"CG y", "m", source, c.y, 0.01963, 1e-5});
    out.push_back({"CG z", "m", source, c.z, 0.60368, 1e-5});
    out.push_back({"I_xx", "kg·m²", source, i.cx.x, 613.166, 2e-3});
    out.push_back({"I_yy", "kg·m²", source, i.cz.z, 2267.074, 2e-3});
    out.push_back({"I_zz", "kg·m²", source, i.cy.y, 2498.334, 2e-3});
    out.push_back({"first principal moment", "kg·m²", source, m.x, 613.009, 2e-3});
    out.push_back({"second principal moment", "kg·m²", source, m.y, 2266.939, 2e-3});
    out.push_back({"third principal moment", "kg·m²", source, m.z, 2498.626, 2e-3});
  }

 private:
  static Vec3d center(Stage3& stage, int i) {
    const Vec3d fixed[] = {{0, 0, 0.6}, {0, 0, 0}, {0, 0, 0.4}};
    Vec3d p = fixed[i];
    p.x = stage.value(parts[i].x);
    if (parts[i].y) p.y = stage.value(parts[i].y);
    if (parts[i].z) p.z = stage.value(parts[i].z);
    return p;
  }

  /// The composite by hand, in the chapter's axes, with one mass and one place as given.
  static geometry::MassProperties3 composite(Stage3& stage, double fuel, double driver_x) {
    geometry::MassProperties3 sum;
    for (int i = 0; i < 3; ++i) {
      geometry::MassProperties3 box;
      box.mass = i == 2 ? fuel : stage.value(parts[i].mass);
      box.center = center(stage, i);
      if (i == 1) box.center.x = driver_x;
      const Vec3d s = parts[i].size;
      box.inertia = Mat3d::diagonal({box.mass * (s.y * s.y + s.z * s.z) / 12, box.mass * (s.z * s.z + s.x * s.x) / 12,
                                     box.mass * (s.x * s.x + s.y * s.y) / 12});
      sum = i == 0 ? box : geometry::combine(sum, box);
    }
    return sum;
  }

  void curves(Stage3& stage) {
    const double fuel = stage.value("fuel_mass"), driver = stage.value("driver_x");
    for (int i = 0; i <= 40; ++i) {
      const double m = 1 + 9.975 * i, x = 0.2 + 0.09 * i;
      stage.sample(0, 0, m, composite(stage, m, driver).center.x);
      stage.sample(1, 0, x, composite(stage, fuel, x).inertia.cz.z);
    }
    stage.sample(0, 1, fuel, properties_.center.x);
    stage.sample(1, 1, driver, properties_.inertia.cy.y);
  }

  static void ring(Stage3& stage, Vec3d at, double radius, int axis) {
    // A regular 16-gon by rotation: (c, s) of 22.5°.
    constexpr double c = 0.92387953251128674, s = 0.38268343236508977;
    double u = radius, v = 0;
    for (int i = 0; i < 16; ++i) {
      const double u2 = c * u - s * v, v2 = s * u + c * v;
      const auto place = [&](double a, double b) {
        return axis == 0 ? Vec3d{0, a, b} : axis == 1 ? Vec3d{b, 0, a} : Vec3d{a, b, 0};
      };
      stage.line(at + place(u, v), at + place(u2, v2), pen(0xffffff));
      u = u2;
      v = v2;
    }
  }

  static void wireframes(Stage3& stage, const Pose3& pose) {
    for (int i = 0; i < 3; ++i) {
      const Vec3d half = 0.5 * parts[i].size;
      const Vec3f h(Vec3d{half.x, half.z, half.y}), at(to_world(center(stage, i)));
      const auto corner = [&](int k) {
        return world_point(pose, at + Vec3f{k & 1 ? h.x : -h.x, k & 2 ? h.y : -h.y, k & 4 ? h.z : -h.z});
      };
      for (int k = 0; k < 8; ++k)
        for (const int bit : {1, 2, 4})
          if (!(k & bit)) stage.line(corner(k), corner(k | bit), pen(parts[i].color));
    }
  }

  rigid::BodyId body_;
  geometry::MassProperties3 properties_;
};

}  // namespace

std::unique_ptr<Demo> make_mass_properties() { return std::make_unique<CompositeMass>(); }

}  // namespace carom::host::demo
