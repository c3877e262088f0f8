#include "apps/host/stage.h"

#include <algorithm>
#include <utility>

namespace carom::host {

StageBase::StageBase(Declaration& declaration, const SimulationOptions& options)
    : declaration_(declaration), options_(options) {
  for (const Parameter& parameter : declaration.parameters) state.values.push_back(parameter.value);
  state.inputs.resize(declaration.inputs.size());
  state.presses.resize(declaration.inputs.size());
}

double StageBase::value(std::string_view name) {
  for (std::size_t i = 0; i < declaration_.parameters.size(); ++i)
    if (declaration_.parameters[i].name == name) return state.values[i];
  fail({"demo " + declaration_.id + " asks for a parameter it does not declare: " + std::string(name)});
  return 0;
}

void StageBase::set_value(std::string_view name, double value) {
  for (std::size_t i = 0; i < declaration_.parameters.size(); ++i) {
    if (declaration_.parameters[i].name != name) continue;
    state.values_changed = state.values_changed || state.values[i] != value;
    state.values[i] = value;
  }
}

double StageBase::input(std::string_view action) const {
  for (std::size_t i = 0; i < declaration_.inputs.size(); ++i)
    if (declaration_.inputs[i].action == action) return state.inputs[i];
  return 0;
}

int StageBase::presses(std::string_view action) {
  for (std::size_t i = 0; i < declaration_.inputs.size(); ++i)
    if (declaration_.inputs[i].action == action) return std::exchange(state.presses[i], 0);
  return 0;
}

void StageBase::sample(int plot, int series, double x, double y) {
  if (!math::is_finite(x) || !math::is_finite(y)) return;
  if (state.samples.size() >= max_samples) {
    // Nobody collects: thin what waits instead of growing.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < state.samples.size(); i += 2) state.samples[kept++] = state.samples[i];
    state.samples.resize(kept);
  }
  state.samples.push_back({plot, series, x, y});
}

void StageBase::line(math::Vec3d a, math::Vec3d b, std::uint32_t rgba) {
  if (state.lines.size() < max_lines && math::is_finite(a) && math::is_finite(b)) state.lines.push_back({a, b, rgba});
}

void StageBase::say(std::string message) {
  if (message == state.message) return;
  state.message = std::move(message);
  state.message_changed = true;
}

namespace {
/// Of so many points, every k-th is shown.
std::size_t stride_for(std::size_t count, std::size_t shown) {
  const std::size_t room = max_points > shown ? max_points - shown : 1;
  return (count + room - 1) / room;
}
}  // namespace

void StageBase::points(std::span<const math::Vec3f> positions, float radius, std::uint32_t rgba) {
  Points& out = state.points;
  const std::size_t stride = stride_for(positions.size(), out.positions.size());
  for (std::size_t i = 0; i < positions.size() && out.positions.size() < max_points; i += stride)
    out.positions.push_back(positions[i]), out.radii.push_back(radius), out.rgbas.push_back(rgba);
}

void StageBase::points(std::span<const math::Vec3f> positions, std::span<const float> radii,
                       std::span<const std::uint32_t> rgbas) {
  if (radii.size() != positions.size() || rgbas.size() != positions.size())
    return fail({"points: " + std::to_string(positions.size()) + " positions, " + std::to_string(radii.size()) +
                 " radii and " + std::to_string(rgbas.size()) + " colours; expected as many of each"});
  Points& out = state.points;
  const std::size_t stride = stride_for(positions.size(), out.positions.size());
  for (std::size_t i = 0; i < positions.size() && out.positions.size() < max_points; i += stride)
    out.positions.push_back(positions[i]), out.radii.push_back(radii[i]), out.rgbas.push_back(rgbas[i]);
}

int StageBase::add_surface(std::vector<std::uint32_t> triangles, std::uint32_t rgba) {
  state.surfaces.push_back({{}, std::move(triangles), rgba, 1});
  return int(state.surfaces.size()) - 1;
}

void StageBase::set_surface(int surface, std::span<const math::Vec3f> corners) {
  if (surface < 0 || std::size_t(surface) >= state.surfaces.size())
    return fail({"set_surface: there is no surface " + std::to_string(surface)});
  Surface& shown = state.surfaces[std::size_t(surface)];
  if (corners.size() < shown.corners.size() || shown.corners.empty())
    for (const std::uint32_t corner : shown.triangles)
      if (corner >= corners.size())
        return fail({"set_surface: a triangle names corner " + std::to_string(corner) + " of " +
                     std::to_string(corners.size())});
  shown.corners.assign(corners.begin(), corners.end());
}

void StageBase::set_surface(int surface, std::span<const math::Vec3f> corners, std::vector<std::uint32_t> triangles) {
  if (surface >= 0 && std::size_t(surface) < state.surfaces.size()) {
    Surface& shown = state.surfaces[std::size_t(surface)];
    shown.triangles = std::move(triangles);
    ++shown.topology;
    shown.corners.clear();  // so that the new triangles are looked at
  }
  set_surface(surface, corners);
}

void StageBase::fail(const core::Error& error) {
  if (state.status.ok()) state.status = error;
}

template <class D>
void Stage<D>::start(rigid::WorldDef<D> definition) {
  if (!definition.scheduler) definition.threads = options_.threads;
  definition.profiler = options_.profiler;
  check(rigid::World<D>::check(definition));
  for (const Actor& actor : actors_) removed_.push_back(actor.id);
  actors_.clear();
  own_ = rigid::World<D>(definition);
  world_ = &own_;
}

template <class D>
void Stage<D>::use(rigid::World<D>& world) {
  world_ = &world;
  adopt_all(false);
}

template <class D>
rigid::BodyId Stage<D>::add(const rigid::BodyDef<D>& definition, std::initializer_list<Part> parts,
                            std::uint32_t color) {
  const BodyId body = keep(world_->create_body(definition));
  if (!body) return body;
  for (const Part& part : parts) keep(world_->add_shape(body, part.shape, part.definition));
  adopt(body, color);
  return body;
}

template <class D>
void Stage<D>::adopt(BodyId body, std::uint32_t color) {
  actors_.push_back({body, next_id_++, color});
  added_.push_back(actors_.back().id);
}

template <class D>
rigid::BodyId Stage<D>::add(const rigid::BodyDef<D>& definition, const typename D::Shape& shape,
                            const rigid::ShapeDef<D>& shape_definition, std::uint32_t color) {
  return add(definition, {{shape, shape_definition}}, color);
}

template <class D>
void Stage<D>::remove(BodyId body) {
  for (std::size_t i = 0; i < actors_.size(); ++i) {
    if (!(actors_[i].body == body)) continue;
    const auto waiting = std::find(added_.begin(), added_.end(), actors_[i].id);
    if (waiting != added_.end())
      added_.erase(waiting);
    else
      removed_.push_back(actors_[i].id);
    actors_.erase(actors_.begin() + std::ptrdiff_t(i));
    break;
  }
  check(world_->destroy_body(body));
}

template <class D>
void Stage<D>::adopt_all(bool keep_known) {
  if (!keep_known) {
    for (const Actor& actor : actors_) removed_.push_back(actor.id);
    actors_.clear();
  }
  std::erase_if(actors_, [this](const Actor& actor) {
    const bool gone = !world_->contains(actor.body);
    if (gone) removed_.push_back(actor.id);
    return gone;
  });
  std::vector<BodyId> all;
  world_->bodies(all);
  // In creation order what is known comes first, unless the demo made bodies behind the stage's back.
  const std::size_t known = actors_.size();
  bool prefix = known <= all.size();
  for (std::size_t i = 0; prefix && i < known; ++i) prefix = all[i] == actors_[i].body;
  for (std::size_t i = prefix ? known : 0; i < all.size(); ++i) {
    const auto is_it = [&](const Actor& actor) { return actor.body == all[i]; };
    if (!prefix && std::any_of(actors_.begin(), actors_.begin() + std::ptrdiff_t(known), is_it)) continue;
    actors_.push_back({all[i], next_id_++, 0});
    added_.push_back(actors_.back().id);
  }
}

template <class D>
void Stage<D>::redraw(BodyId body) {
  for (Actor& actor : actors_) {
    if (!(actor.body == body)) continue;
    if (std::find(added_.begin(), added_.end(), actor.id) != added_.end()) return;
    removed_.push_back(actor.id);
    actor.id = next_id_++;
    added_.push_back(actor.id);
  }
}

template <class D>
void Stage<D>::set_color(BodyId body, std::uint32_t color) {
  for (Actor& actor : actors_) {
    if (!(actor.body == body) || actor.color == color) continue;
    actor.color = color;
    redraw(body);
  }
}

template <class D>
rigid::BodyId Stage<D>::floor(double level, const rigid::Material& material) {
  rigid::BodyDef<D> definition;
  definition.type = rigid::BodyType::fixed;
  definition.position.y = level;
  definition.name = "ground";
  rigid::ShapeDef<D> shape;
  shape.material = material;
  if constexpr (D::dimension == 2) {
    shape.local.p.y = -1;
    return add(definition, geometry::make_box2({200, 1}), shape);
  } else {
    return add(definition, geometry::Plane{}, shape);
  }
}

template <class D>
typename Stage<D>::Memory Stage<D>::remember() const {
  return {
      actors_, state.values, state.inputs, state.presses, state.surfaces, state.message, declaration_.camera.follow};
}

template <class D>
void Stage<D>::recall(const Memory& memory) {
  // Ids rise and are never used twice, so equal ids are the same body.
  const auto has = [](const std::vector<Actor>& actors, std::uint32_t id) {
    const auto found = std::lower_bound(actors.begin(), actors.end(), id,
                                        [](const Actor& a, std::uint32_t wanted) { return a.id < wanted; });
    return found != actors.end() && found->id == id;
  };
  for (const Actor& actor : actors_)
    if (!has(memory.actors, actor.id)) removed_.push_back(actor.id);
  for (const Actor& actor : memory.actors)
    if (!has(actors_, actor.id)) added_.push_back(actor.id);
  actors_ = memory.actors;
  state.values = memory.values;
  state.inputs = memory.inputs;
  state.presses = memory.presses;
  // What is drawn for one step is drawn anew by the next one. Where a surface was torn, the page gets its triangles.
  state.lines.clear();
  state.points.clear();
  for (std::size_t i = 0; i < memory.surfaces.size() && i < state.surfaces.size(); ++i) {
    const std::uint32_t topology = state.surfaces[i].topology;
    state.surfaces[i] = memory.surfaces[i];
    state.surfaces[i].topology = topology + 1;
  }
  state.values_changed = true;
  say(memory.message);
  follow(memory.follow);
}

template class Stage<rigid::Dim2>;
template class Stage<rigid::Dim3>;

void Trail::add(math::Vec3d p) {
  if (!points_.empty() && math::distance_squared(points_.back(), p) < spacing_ * spacing_) return;
  if (points_.size() >= limit_) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points_.size(); i += 2) points_[kept++] = points_[i];
    points_.resize(kept);
    spacing_ *= 2;
  }
  points_.push_back(p);
}

void Trail::draw(StageBase& stage, std::uint32_t rgba) const {
  for (std::size_t i = 1; i < points_.size(); ++i) stage.line(points_[i - 1], points_[i], rgba);
}

}  // namespace carom::host
