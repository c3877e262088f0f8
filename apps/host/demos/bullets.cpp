// Fast bodies and thin walls: continuous collision lets none through.
#include "apps/host/demos/demos.h"
#include "carom/geometry/hull.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Bullets final : public Repeatable<Bullets, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "bullets";
    d.title = "Bullets and a thin wall";
    d.summary = "Balls, boxes, rods and hulls at 400 m/s against a wall of ten centimetres: none passes.";
    d.group = "Collisions";
    d.chapter = "14";
    d.text =
        "In a step of 1/60 s such a bullet flies 6.7 m, far more than the wall is thick. Looking only at where bodies "
        "are after a step, most would be found on the other side. Each fast body is swept along its way instead, its "
        "rotation too, and stopped where it first touches.\n\n"
        "  t = first root of the distance d(t) = 0 along the motion\n\n"
        "The counter in the corner says how many were fired and how many are behind the wall.";
    d.duration = 8;
    d.camera = {{-7, 5, 15}, {0, 2.4, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed of the bullets", "m/s", "m/s", "", 10, 400, 5, 400, true},
        {"thickness", "Thickness of the wall", "m", "cm", "", 0.01, 0.5, 0.01, 0.1, false},
        {"spin", "Spin of the bullets", "rad/s", "rad/s", "about an axis across their way", 0, 200, 5, 0, true},
    };
    d.plots = {{"Fired and passed", {"time", "s"}, {"bullets", ""}, {{"fired"}, {"behind the wall"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    const float half = 0.5f * stage.valuef("thickness");
    rigid::BodyDef<Dim3> wall;
    wall.type = rigid::BodyType::fixed;
    wall.name = "wall";
    wall.position = {half, 2.5, 0};
    stage.add(wall, geometry::Box{{half, 2.5f, 4}}, {}, dark);
    constexpr Vec3f corner[] = {{0.3f, 0, 0}, {-0.1f, 0.14f, 0}, {-0.1f, -0.08f, 0.13f}, {-0.1f, -0.08f, -0.13f}};
    const auto hull = stage.keep(geometry::make_hull(corner));
    forms_ = {geometry::Sphere{0.12f}, geometry::Box{{0.1f, 0.1f, 0.1f}}, geometry::Capsule3{0.25f, 0.06f}, hull};
  }

  void before_step(Stage3& stage) override {
    if (stage.world().step_count() % 4 != 0) return;
    if (bullets_.size() >= 160) {
      stage.remove(bullets_.front().body);
      bullets_.erase(bullets_.begin());
    }
    rigid::BodyDef<Dim3> body;
    body.name = "bullet";
    // Along the wall in a fixed pattern; the phase of a step at which they strike differs from shot to shot.
    body.position = {-14 - 0.37 * (fired_ % 19), 0.6 + 0.31 * (fired_ % 13), 0.53 * (fired_ * 5 % 14) - 3.5};
    body.linear_velocity = {stage.valuef("speed"), 0.3f * float(fired_ % 5), 0};
    body.angular_velocity = {0, 0, stage.valuef("spin")};
    body.bullet = true;
    rigid::ShapeDef<Dim3> shape;
    shape.density = 7850;
    constexpr std::uint32_t colors[] = {orange, blue, green, violet};
    bullets_.push_back({stage.add(body, forms_[std::size_t(fired_ % 4)], shape, colors[fired_ % 4]), body.position});
    ++fired_;
  }

  void after_step(Stage3& stage) override {
    for (Shot& shot : bullets_) {
      const Vec3d p = stage.at(shot.body).pose.position, way = p - shot.last;
      if (shot.last.x < 0 && p.x > 0) {
        // Where it crossed the plane of the wall: over or round it is no way through.
        const Vec3d at = shot.last + way * (-shot.last.x / way.x);
        passed_ += at.y < 5 && abs(at.z) < 4;
      }
      shot.last = p;
    }
    if (stage.world().step_count() % 10 != 0) return;
    stage.sample(0, 0, stage.world().time(), fired_);
    stage.sample(0, 1, stage.world().time(), passed_);
    stage.say(format("%.0f fired, %.0f behind the wall", double(fired_), double(passed_)));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"bullets fired", "", "fifteen a second", double(fired_), 120, 0});
    out.push_back({"bullets behind the wall", "", "none tunnels", double(passed_), 0, 0});
  }

 private:
  std::vector<geometry::Shape3> forms_;
  struct Shot {
    BodyId body;
    Vec3d last;
  };
  std::vector<Shot> bullets_;
  int fired_ = 0, passed_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_bullets() { return std::make_unique<Bullets>(); }

}  // namespace carom::host::demo
