// A fortress of tiles in the plane: shot breaks tiles, and what hangs on nothing any more falls as rubble.
#include "apps/host/demos/terrain/list.h"
#include "carom/rigid/tile_ground.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Fortress final : public Repeatable<Fortress, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "fortress";
    d.title = "Tiles that break";
    d.summary = "Shot breaks the tiles it strikes. What is cut off from the ground falls in one piece. Throw your own.";
    d.group = "Terrain";
    d.text =
        "The ground and the walls are one grid of tiles, seen by contacts as the outlines of what is solid: a ball "
        "rolls along a row of tiles as along one plank. A hit breaks the tiles within a radius that grows with its "
        "energy; only outlines that changed are made anew, and only what lies on those wakes.\n\n"
        "After every hit the tiles that still hang on the ground are found by flooding; the others leave the grid as "
        "one body each, with their mass.";
    d.dimension = 2;
    d.duration = 12;
    d.camera.target = {0, 6, 0};
    d.camera.height = 16;
    d.parameters = {
        {"pace", "Time between shots", "s", "s", "", 0.3, 4, 0.1, 1.2, true},
        {"speed", "Speed of the shot", "m/s", "m/s", "", 10, 60, 1, 28, true},
        {"strength", "Energy to break a tile", "J", "kJ", "", 200, 2e4, 0, 2000, true},
    };
    d.plots = {{"Tiles", {"time", "s"}, {"tiles", ""}, {{"standing"}, {"fallen"}}}};
    d.inputs = {{"fire", "Fire", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.looks_in_materials = true;
    std::vector<std::uint8_t> cells(std::size_t(columns_ * rows_), 0);
    const auto fill = [&](int x, int y, int w, int h, std::uint8_t what) {
      for (int j = y; j < y + h; ++j)
        for (int i = x; i < x + w; ++i) cells[index(i, j)] = what;
    };
    fill(0, 0, columns_, ground_rows_, earth);
    for (int i = 0; i < columns_; ++i) fill(i, ground_rows_ - 1, 1, 1 + (i % 11 == 3), earth);
    const int base = ground_rows_;
    for (const int x : {26, 44}) {  // two towers with battlements
      fill(x, base, 6, 16, stone);
      fill(x + 2, base + 2, 2, 4, 0), fill(x + 2, base + 9, 2, 3, 0);
      for (int k = 0; k < 3; ++k) fill(x + 2 * k + (k == 2), base + 16, 1, 1, stone);
    }
    fill(32, base, 12, 7, brick), fill(36, base, 4, 4, 0);  // a wall with a gate
    fill(32, base + 13, 12, 2, brick);                      // a bridge between the towers
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.name = "tiles";
    body.position = {-0.5 * columns_ * double(cell_), 0};
    body_ = stage.add(body, {}, 0);
    definition_.material.friction = 0.7f;
    definition_.hit_events = true;
    const auto surface = [](std::uint32_t color) {
      rigid::SurfaceMaterial<Dim2> s;
      s.material.friction = 0.7f;
      s.material.user_id = 0xff000000u | color;
      return s;
    };
    definition_.surfaces = {surface(colors_[0]), surface(colors_[1]), surface(colors_[2])};
    core::Result<rigid::TileGround> made =
        rigid::TileGround::create(stage.world(), body_, columns_, rows_, cell_, cells, definition_);
    if (!made.ok()) return stage.fail(made.error());
    tiles_ = std::move(made).value();
    for (const std::uint32_t color : colors_) (void)stage.add_surface({}, color << 8 | 0xff);
    show(stage);
    for (int n = 0; n < 6; ++n) {
      rigid::BodyDef<Dim2> barrel;
      barrel.name = "barrel";
      barrel.position = {-5.4 + 0.1 * 20 + 0.62 * n, (base + 15) * double(cell_) + 0.32};
      rigid::ShapeDef<Dim2> d;
      d.density = 300;
      d.material.user_id = 0xff000000u | gold;
      stage.add(barrel, geometry::Circle{0.3f}, d);
    }
    first_ = count();
  }

  void before_step(Stage2& stage) override {
    const double t = stage.world().time();
    if (t < next_ && stage.presses("fire") == 0) return;
    next_ = t + stage.value("pace");
    rigid::BodyDef<Dim2> shot;
    shot.name = "shot";
    shot.bullet = true;
    shot.position = {-13, 4};
    const double lift = 0.15 + 0.06 * (shots_ % 5);
    shot.linear_velocity = Vec2f(Vec2d{cos(lift), sin(lift)} * stage.value("speed"));
    rigid::ShapeDef<Dim2> iron;
    iron.density = 600;
    iron.hit_events = true;
    iron.material.user_id = 0xff000000u | dark;
    stage.add(shot, geometry::Circle{0.22f}, iron);
    ++shots_;
  }

  void after_step(Stage2& stage) override {
    std::vector<std::pair<Vec2d, double>> blows;
    const std::span<const rigid::ShapeId> outlines = tiles_->shapes();
    for (const rigid::ContactHitEvent<Dim2>& hit : stage.world().events().contact_hit) {
      const auto is_tile = [&](rigid::ShapeId s) {
        return std::find(outlines.begin(), outlines.end(), s) != outlines.end();
      };
      if (!is_tile(hit.shape_a) && !is_tile(hit.shape_b)) continue;
      const double energy = 0.5 * double(hit.impulse) * double(hit.approach_speed);
      if (energy > 0.25 * stage.value("strength"))
        blows.push_back(
            {hit.point + 0.3 * double(cell_) * Vec2d(is_tile(hit.shape_a) ? -hit.normal : hit.normal), energy});
    }
    for (const auto& [point, energy] : blows) shatter(stage, point, energy);
    if (!blows.empty()) drop_loose(stage);
    const int now = count();
    stage.sample(0, 0, stage.world().time(), now);
    stage.sample(0, 1, stage.world().time(), fallen_);
    stage.say(format("%.0f tiles stand, %.0f broken, %.0f fell as rubble", now, first_ - now - fallen_, fallen_));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"tiles broken at least", "", "some by every shot that hits",
                   min(double(first_ - count() - fallen_), 20.0), 20, 0});
    out.push_back({"tiles that fell in pieces at least", "", "what was cut off", min(double(fallen_), 1.0), 1, 0});
    out.push_back({"tiles that hang on nothing", "", "none stays in the air", double(loose().size()), 0, 0});
    (void)stage;
  }

 private:
  enum : std::uint8_t { empty, earth, stone, brick };
  static constexpr int columns_ = 80, rows_ = 32, ground_rows_ = 4;
  static constexpr float cell_ = 0.35f;
  static constexpr std::uint32_t colors_[3] = {0x7a6a45, 0x8d949c, 0xb0614a};
  static std::size_t index(int i, int j) { return std::size_t(j) * std::size_t(columns_) + std::size_t(i); }
  int count() const {
    int n = 0;
    for (int j = ground_rows_; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i) n += tiles_->at(i, j) != 0;
    return n;
  }
  Vec2d middle(int i, int j) const { return {double(cell_) * (i + 0.5 - 0.5 * columns_), double(cell_) * (j + 0.5)}; }
  void clear(Stage2& stage, int i, int j) {
    const std::uint8_t none = 0;
    stage.check(tiles_->set_cells(stage.world(), {i, j, 1, 1}, {&none, 1}));
  }
  /// As many of the nearest tiles as the energy breaks; the bedrock holds.
  void shatter(Stage2& stage, Vec2d point, double energy) {
    struct Near {
      double distance;
      int i, j;
    };
    std::vector<Near> near;
    for (int j = 1; j < rows_; ++j)
      for (int i = 0; i < columns_; ++i)
        if (const double d = length(middle(i, j) - point); tiles_->at(i, j) != 0 && d < 5 * double(cell_))
          near.push_back({d, i, j});
    std::sort(near.begin(), near.end(), [](const Near& a, const Near& b) {
      return a.distance != b.distance ? a.distance < b.distance : index(a.i, a.j) < index(b.i, b.j);
    });
    const std::size_t broken = std::min(near.size(), std::size_t(min(energy / stage.value("strength"), 12.0) + 1));
    for (std::size_t n = 0; n < broken; ++n) clear(stage, near[n].i, near[n].j);
    if (broken > 0) show(stage);
  }
  /// Groups of tiles that no way over edges joins to the bottom row.
  std::vector<std::vector<int>> loose() const {
    std::vector<int> group(std::size_t(columns_ * rows_), -1);
    std::vector<std::vector<int>> found;
    for (int start = 0; start < columns_ * rows_; ++start) {
      if (group[std::size_t(start)] >= 0 || tiles_->at(start % columns_, start / columns_) == 0) continue;
      std::vector<int> members{start};
      group[std::size_t(start)] = start;
      bool held = false;
      for (std::size_t n = 0; n < members.size(); ++n) {
        const int i = members[n] % columns_, j = members[n] / columns_;
        held = held || j == 0;
        for (const auto& [di, dj] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
          const int x = i + di, y = j + dj;
          if (x < 0 || y < 0 || x >= columns_ || y >= rows_ || tiles_->at(x, y) == 0 || group[index(x, y)] >= 0)
            continue;
          group[index(x, y)] = start;
          members.push_back(y * columns_ + x);
        }
      }
      if (!held) found.push_back(std::move(members));
    }
    return found;
  }
  /// Each of them becomes a body of its rows of tiles.
  void drop_loose(Stage2& stage) {
    for (std::vector<int>& members : loose()) {
      std::sort(members.begin(), members.end());
      rigid::BodyDef<Dim2> body;
      body.name = "rubble";
      const Vec2d origin = middle(members[0] % columns_, members[0] / columns_);
      body.position = origin;
      const BodyId id = stage.keep(stage.world().create_body(body));
      for (std::size_t n = 0; n < members.size();) {
        const std::uint8_t what = tiles_->at(members[n] % columns_, members[n] / columns_);
        std::size_t end = n + 1;
        while (end < members.size() && members[end] == members[end - 1] + 1 && members[end] % columns_ != 0 &&
               tiles_->at(members[end] % columns_, members[end] / columns_) == what)
          ++end;
        const int length = int(end - n);
        const Vec2d center =
            middle(members[n] % columns_, members[n] / columns_) + Vec2d{0.5 * (length - 1) * double(cell_), 0};
        rigid::ShapeDef<Dim2> d;
        d.density = 1800;
        d.material.friction = 0.7f;
        d.material.user_id = 0xff000000u | colors_[what - 1];
        const float radius = 0.01f, half = 0.5f * cell_ - radius;
        (void)stage.keep(stage.world().add_shape(
            id,
            geometry::make_box2({half + 0.5f * cell_ * float(length - 1), half}, radius, {Vec2f(center - origin), {}}),
            d));
        n = end;
      }
      fallen_ += int(members.size());
      for (const int m : members) clear(stage, m % columns_, m / columns_);
      stage.adopt(id);
    }
    show(stage);
  }
  /// The outlines anew, and the tiles within them: stones with a joint between them, earth by the row.
  void show(Stage2& stage) {
    stage.redraw(body_);
    for (int what = earth; what <= brick; ++what) {
      std::vector<math::Vec3f> corners;
      std::vector<std::uint32_t> triangles;
      for (int j = 0; j < rows_; ++j)
        for (int i = 0; i < columns_; ++i) {
          if (tiles_->at(i, j) != what) continue;
          const int first = i;
          while (what == earth && i + 1 < columns_ && tiles_->at(i + 1, j) == earth) ++i;
          const float half = (what == earth ? 0.5f : 0.455f) * cell_;
          const Vec2f low = Vec2f(middle(first, j)) - Vec2f{half, half}, high = Vec2f(middle(i, j)) + Vec2f{half, half};
          for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u})
            triangles.push_back(static_cast<std::uint32_t>(corners.size()) + k);
          corners.insert(corners.end(),
                         {{low.x, low.y, 0}, {high.x, low.y, 0}, {high.x, high.y, 0}, {low.x, high.y, 0}});
        }
      // (Without corners the host would keep what it showed last.)
      if (corners.empty()) corners.resize(1);
      stage.set_surface(what - earth, corners, std::move(triangles));
    }
  }

  BodyId body_;
  rigid::ShapeDef<Dim2> definition_;
  std::optional<rigid::TileGround> tiles_;
  double next_ = 1;
  int shots_ = 0, first_ = 0, fallen_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_fortress() { return std::make_unique<Fortress>(); }

}  // namespace carom::host::demo
