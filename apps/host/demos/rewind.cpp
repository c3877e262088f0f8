// Time that can be turned back: snapshots that restore to the bit.
#include <deque>

#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Rewind final : public Repeatable<Rewind, Demo3> {
 public:
  /// It keeps its own time; a copy of that would cost more than the run again.
  std::unique_ptr<Demo> copy() const override { return nullptr; }
  Declaration declaration() const override {
    Declaration d;
    d.id = "rewind";
    d.title = "Rewind: snapshots and rollback";
    d.summary = "Knock a tower over, hold Rewind, and let it fall again, bit for bit the same.";
    d.group = "Rigid bodies";
    d.text =
        "A snapshot holds everything that the next step depends on: poses and velocities, contacts with the impulses "
        "that the solver remembers, sleep timers. Restored, the world goes on with the same bits, whatever was made, "
        "destroyed or thrown in between. That is what rollback in network games, replays and editors need.\n\n"
        "One snapshot is kept for every step of the last eight seconds, as the difference to the one before it: what "
        "sleeps or stands still costs nothing. Once a second the demo goes eight steps back and simulates them again, "
        "as a game does when a packet comes late, and compares the state hashes.";
    d.duration = 6;
    d.camera = {{9, 6.5, 13}, {0, 3, 0}};
    d.ground = 0;
    d.parameters = {
        {"storeys", "Storeys", "", "", "of the tower", 2, 14, 1, 9, false},
        {"ball_speed", "Speed of the ball", "m/s", "m/s", "", 5, 60, 1, 26, true},
    };
    d.plots = {
        {"Size of a snapshot", {"time since the start", "s"}, {"size", "kB"}, {{"difference to the step before"}}},
        {"Time that the world shows", {"time since the start", "s"}, {"time of the world", "s"}, {{"world"}}}};
    d.inputs = {{"rewind", "Rewind", {"ArrowLeft", "KeyZ"}, false, 1}, {"throw", "Throw a ball", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    rigid::Material rough;
    rough.friction = 0.5f;
    stage.floor(0, rough);
    rigid::ShapeDef<Dim3> shape;
    shape.material = rough;
    shape.density = 600;
    const int storeys = stage.count("storeys");
    for (int i = 0; i < storeys; ++i)
      for (int k = 0; k < 3; ++k) {
        rigid::BodyDef<Dim3> body;
        body.name = "beam";
        const double across = 1.05 * (k - 1), height = 0.3 + 0.6 * i;
        const bool turned = i % 2 == 1;
        body.position = turned ? Vec3d{across, height, 0} : Vec3d{0, height, across};
        const Vec3f half = turned ? Vec3f{0.5f, 0.3f, 1.55f} : Vec3f{1.55f, 0.3f, 0.5f};
        constexpr std::uint32_t wood[] = {0xc9995c, 0xb98749, 0xd6ab70};
        stage.add(body, geometry::Box{half}, shape, wood[(i + k) % 3]);
      }
    stage.world().snapshot(now_);
  }

  void before_step(Stage3& stage) override {
    rewinding_ = stage.input("rewind") > 0;
    const bool first = stage.world().step_count() == 60 && !thrown_;
    if (!rewinding_ && (stage.presses("throw") > 0 || first)) shoot(stage);
  }

  core::Status step(Stage3& stage) override {
    ++shown_;
    if (rewinding_) return back(stage);
    core::Status status = stage.world().step(float(stage.declaration().dt));
    if (!status.ok()) return status;
    if (stage.world().step_count() % 60 == 0) rehearse(stage);
    return remember(stage);
  }

  void after_step(Stage3& stage) override {
    const double t = shown_ * stage.declaration().dt;
    if (!rewinding_ && !past_.empty()) stage.sample(0, 0, t, 1e-3 * double(past_.back().size()));
    stage.sample(1, 0, t, stage.world().time());
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"rollbacks of eight steps", "", "one a second", double(rehearsals_), 6, 0});
    out.push_back({"of them with another state hash", "", "restored to the bit", double(differing_), 0, 0});
  }

 private:
  static constexpr std::size_t most_ = 480;  // steps that are kept

  void shoot(Stage3& stage) {
    thrown_ = true;
    rigid::BodyDef<Dim3> ball;
    ball.name = "ball";
    ball.position = {0.4 * (stage.world().counters().bodies % 3 - 1), 3.2, 11};
    ball.linear_velocity = {0, 1.5f, -stage.valuef("ball_speed")};
    ball.bullet = true;
    rigid::ShapeDef<Dim3> shape;
    shape.density = 7850;
    stage.add(ball, geometry::Sphere{0.6f}, shape, red);
  }

  /// Keeps the step just taken, as the way back from it to the one before.
  core::Status remember(Stage3& stage) {
    std::swap(now_, before_);
    stage.world().snapshot(now_);
    past_.push_back(before_.encode(now_));
    if (past_.size() > most_) past_.pop_front();
    return {};
  }

  core::Status back(Stage3& stage) {
    if (past_.empty()) {
      stage.say("this is as far as it remembers");
      return {};
    }
    core::Result<rigid::Snapshot3> earlier = rigid::Snapshot3::decode(past_.back(), now_);
    if (!earlier.ok()) return earlier.error();
    past_.pop_back();
    now_ = std::move(earlier).value();
    if (const core::Status restored = stage.world().restore(now_); !restored.ok()) return restored;
    stage.adopt_all();
    stage.say("rewinding: the world is at " + format("%.2f s", stage.world().time()));
    return {};
  }

  /// Eight steps back and forth again must end in the same bits. The steps since are played without new input, so the
  /// rehearsal starts where nothing was thrown.
  void rehearse(Stage3& stage) {
    const std::uint64_t end = stage.world().state_hash();
    const float dt = float(stage.declaration().dt);
    stage.world().snapshot(rehearsal_);
    std::uint64_t first = 0;
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < 8; ++i) stage.check(stage.world().step(dt));
      if (round == 0)
        first = stage.world().state_hash();
      else if (stage.world().state_hash() != first)
        ++differing_;
      stage.check(stage.world().restore(rehearsal_));
    }
    if (stage.world().state_hash() != end) ++differing_;
    ++rehearsals_;
    stage.say(format("%.0f rollbacks of eight steps, %.0f of them differed", double(rehearsals_), double(differing_)));
  }

  rigid::Snapshot3 now_, before_, rehearsal_;
  std::deque<std::vector<std::byte>> past_;
  long long shown_ = 0;
  int rehearsals_ = 0, differing_ = 0;
  bool rewinding_ = false, thrown_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_rewind() { return std::make_unique<Rewind>(); }

}  // namespace carom::host::demo
