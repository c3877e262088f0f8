// World's members that take and restore snapshots.
#pragma once

#include <algorithm>
#include <cstring>

#include "carom/rigid/detail/snapshot_data.h"
#include "carom/rigid/detail/state_check.inl"
#include "carom/rigid/detail/state_visitor.h"
#include "carom/rigid/snapshot.h"

namespace carom::rigid {
namespace detail {

/// What a definition says about the machine and not about the motion.
template <class D>
WorldDef<D> without_machine(WorldDef<D> definition, const WorldDef<D>& machine = {}) {
  definition.threads = machine.threads;
  definition.scheduler = machine.scheduler;
  definition.profiler = machine.profiler;
  definition.simd_width = machine.simd_width;
  return definition;
}

template <class D>
class SnapshotWriter {
 public:
  explicit SnapshotWriter(SnapshotData<D>& to) : to_(to) {
    to_.image.clear();
    to_.sections.clear();
  }
  template <class T>
  void state(const std::vector<T>& v) {
    put(v.data(), v.size());
  }
  template <class T>
  void state(const core::Column<T>& v) {
    put(v.data(), v.size());
  }
  template <class T>
  void state(const T& x) {
    put(&x, 1);
  }
  void bodies(const core::Column<SolverBody<D>>& solver, const core::Column<typename D::Pose>& pose,
              const core::Column<BodyMotion<D>>& motion, const core::Column<BodyRecord>& record) {
    to_.bodies_at = to_.sections.size();
    state(solver), state(pose), state(motion), state(record);
  }
  void begins(StatePart part) { (part == StatePart::trees ? to_.trees_at : to_.pairs_at) = to_.sections.size(); }
  void manifolds(const core::Column<ManifoldRecord<D>>& v) {
    to_.manifolds_at = to_.sections.size();
    state(v);
  }
  template <class T>
  void scratch(const T&) {}
  template <class T>
  void events(const T&) {}
  // Member by member: what lies between members is left to chance when a whole is copied, and equal worlds are to have
  // equal snapshots.
  void definition(const WorldDef<D>& d) {
    const WorldDef<D> plain = without_machine(d);
    const auto& [gravity, substeps, threads, scheduler, profiler, simd_width, allow_sleep, continuous,
                 restitution_threshold, contact_hertz, contact_damping_ratio, contact_push_speed, joint_hertz,
                 joint_damping_ratio, joint_solver, maximum_linear_speed, sleep_time, move_events] = plain;
    put_members(static_cast<std::byte*>(room<WorldDef<D>>(1)), plain, gravity, substeps, threads, scheduler, profiler,
                simd_width, allow_sleep, continuous, restitution_threshold, contact_hertz, contact_damping_ratio,
                contact_push_speed, joint_hertz, joint_damping_ratio, joint_solver, maximum_linear_speed, sleep_time,
                move_events);
  }
  void shapes(const std::vector<ShapeRecord<D>>& v) {
    to_.shapes_at = to_.sections.size();
    std::byte* to = static_cast<std::byte*>(room<ShapeTraits<D>>(v.size()));
    for (const ShapeTraits<D>& traits : v) {
      const auto& [local, body, next, leaf, tree, flags, at_origin, outer_extent, inner_extent, margin, terms] = traits;
      put_members(to, traits, local, body, next, leaf, tree, flags, at_origin, outer_extent, inner_extent, margin,
                  terms);
      to += sizeof traits;
    }
  }
  void names(const std::vector<std::string>& v) {
    std::uint32_t* sizes = static_cast<std::uint32_t*>(room<std::uint32_t>(v.size()));
    std::size_t total = 0;
    for (const std::string& name : v) total += name.size(), *sizes++ = std::uint32_t(name.size());
    char* to = static_cast<char*>(room<char>(total));
    for (const std::string& name : v) to = std::copy(name.begin(), name.end(), to);
  }
  void effectors(const std::vector<EffectorData<D>>& v) { to_.effectors = v; }

 private:
  template <class T, class... Member>
  static void put_members(std::byte* to, const T& whole, const Member&... member) {
    const std::byte* const from = reinterpret_cast<const std::byte*>(&whole);
    const auto put_member = [&](std::span<const std::byte> bytes) {
      std::memcpy(to + (bytes.data() - from), bytes.data(), bytes.size());
    };
    (put_member(std::as_bytes(std::span(&member, 1))), ...);
  }
  template <class T>
  void* room(std::size_t count) {
    const std::size_t first = to_.image.size();
    to_.image.resize(first + (count * sizeof(T) + 7) / 8);
    to_.sections.push_back({first, count, sizeof(T)});
    return to_.image.data() + first;
  }
  template <class T>
  void put(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>, "state that is not plain bytes needs a function of its own");
    void* to = room<T>(count);
    if (count > 0) std::memcpy(to, values, count * sizeof(T));
  }
  SnapshotData<D>& to_;
};

/// Do the sections fit the world's members? Nothing is written.
template <class D>
class SnapshotChecker {
 public:
  explicit SnapshotChecker(const SnapshotData<D>& from) : from_(from) {}
  bool fits() const { return fits_ && next_ == from_.sections.size(); }
  template <class T>
  void state(const std::vector<T>&) {
    expect(sizeof(T), false);
  }
  template <class T>
  void state(const core::Column<T>&) {
    expect(sizeof(T), false);
  }
  template <class T>
  void state(const T&) {
    expect(sizeof(T), true);
  }
  template <class S, class P, class M>
  void bodies(const core::Column<S>& solver, const core::Column<P>& pose, const core::Column<M>& motion,
              const core::Column<BodyRecord>& record) {
    state(solver), state(pose), state(motion), state(record);
  }
  void begins(StatePart) {}
  template <class T>
  void manifolds(const core::Column<T>& v) {
    state(v);
  }
  template <class T>
  void scratch(const T&) {}
  template <class T>
  void events(const T&) {}
  void definition(const WorldDef<D>&) { expect(sizeof(WorldDef<D>), true); }
  void shapes(const std::vector<ShapeRecord<D>>&) {
    const std::uint64_t count = expect(sizeof(ShapeTraits<D>), false);
    fits_ = fits_ && from_.geometry != nullptr && from_.geometry->size() == count;
  }
  void names(const std::vector<std::string>&) {
    const std::uint64_t count = expect(sizeof(std::uint32_t), false);
    const std::uint64_t characters = expect(1, false);
    if (!fits_) return;
    const std::uint32_t* sizes = reinterpret_cast<const std::uint32_t*>(&from_.image[from_.sections[next_ - 2].first]);
    std::uint64_t total = 0;
    for (std::uint64_t i = 0; i < count; ++i) total += sizes[i];
    fits_ = total == characters;
  }
  void effectors(const std::vector<EffectorData<D>>&) {}

 private:
  std::uint64_t expect(std::size_t element, bool one) {
    if (next_ >= from_.sections.size()) return fits_ = false, 0;
    const SnapshotSection& s = from_.sections[next_++];
    fits_ = fits_ && s.element == element && (!one || s.count == 1);
    return s.count;
  }
  const SnapshotData<D>& from_;
  std::size_t next_ = 0;
  bool fits_ = true;
};

template <class D>
class SnapshotReader {
 public:
  explicit SnapshotReader(const SnapshotData<D>& from) : from_(from) {}
  template <class T>
  void state(std::vector<T>& v) {
    list<T>(v);
  }
  template <class T>
  void state(core::Column<T>& v) {
    list<T>(v);
  }
  template <class T>
  void state(T& x) {
    std::memcpy(static_cast<void*>(&x), place(from_.sections[next_++]), sizeof(T));
  }
  template <class S, class P, class M>
  void bodies(core::Column<S>& solver, core::Column<P>& pose, core::Column<M>& motion,
              core::Column<BodyRecord>& record) {
    state(solver), state(pose), state(motion), state(record);
  }
  void begins(StatePart) {}
  template <class T>
  void manifolds(core::Column<T>& v) {
    state(v);
  }
  template <class T>
  void scratch(const T&) {}
  template <class T>
  void events(std::vector<T>& v) {
    v.clear();  // they tell of a step that is not the last one any more
  }
  void definition(WorldDef<D>& d) {
    const WorldDef<D> machine = d;
    state(d);
    d = without_machine(d, machine);
  }
  void shapes(std::vector<ShapeRecord<D>>& v) {
    const SnapshotSection& s = from_.sections[next_++];
    v.resize(std::size_t(s.count));
    const ShapeTraits<D>* from = static_cast<const ShapeTraits<D>*>(place(s));
    for (ShapeRecord<D>& record : v) {
      ShapeTraits<D> traits;
      std::memcpy(static_cast<void*>(&traits), static_cast<const void*>(from++), sizeof traits);
      static_cast<ShapeTraits<D>&>(record) = traits;
    }
  }
  void names(std::vector<std::string>& v) {
    const SnapshotSection& s = from_.sections[next_++];
    const std::uint32_t* sizes = static_cast<const std::uint32_t*>(place(s));
    const char* from = static_cast<const char*>(place(from_.sections[next_++]));
    v.resize(std::size_t(s.count));
    for (std::string& name : v) name.assign(from, *sizes), from += *sizes++;
  }
  void effectors(std::vector<EffectorData<D>>& v) { v = from_.effectors; }

 private:
  template <class T, class List>
  void list(List& v) {
    const SnapshotSection& s = from_.sections[next_++];
    v.resize(std::size_t(s.count));
    if (s.count > 0) std::memcpy(static_cast<void*>(v.data()), place(s), std::size_t(s.count) * sizeof(T));
  }
  const void* place(const SnapshotSection& s) const { return from_.image.data() + s.first; }
  const SnapshotData<D>& from_;
  std::size_t next_ = 0;
};

/// Whether it is something of the caller's that bytes did not carry.
template <class D>
bool lacks_own(const EffectorDef<D>& definition) {
  if (const auto* custom = std::get_if<CustomEffector<D>>(&definition)) return !custom->model;
  if (const auto* around = std::get_if<Surroundings<D>>(&definition)) return around->environment == nullptr;
  return false;
}

/// The hulls and meshes that a decoded snapshot knows by their fingerprint, out of this world's own.
template <class D>
Result<std::shared_ptr<const std::vector<typename D::Shape>>> find_geometry(const WorldImplementation<D>& world,
                                                                            const SnapshotData<D>& data) {
  if (data.missing.empty()) return data.geometry;
  auto all = std::make_shared<std::vector<typename D::Shape>>(*data.geometry);
  std::vector<std::pair<std::uint64_t, const typename D::Shape*>> known;  // fingerprints
  for (std::size_t slot = 0; slot < data.missing.size(); ++slot) {
    const GeometryRecord& record = data.missing[slot];
    if (record.shared == 0) continue;
    if (known.empty()) {
      for (const ShapeRecord<D>& own : world.shapes.record)
        if (is_shared(own.geometry)) known.push_back({fingerprint(own.geometry), &own.geometry});
      for (const typename D::Shape& own : world.shapes.originals) known.push_back({fingerprint(own), &own});
    }
    bool found = false;
    for (const auto& [print, own] : known)
      if (print == record.fingerprint) {
        (*all)[slot] = *own;
        found = true;
        break;
      }
    if (!found)
      return core::Error{core::text("World::restore: shape #", slot + 1,
                                    " of the snapshot has shared geometry with a fingerprint that no shape of this "
                                    "world has, expected a world with the same hulls and meshes")};
  }
  return std::shared_ptr<const std::vector<typename D::Shape>>(std::move(all));
}

/// Whether what came as bytes is the state of a world: taken apart in one that nobody else has.
template <class D>
Status check_state(const SnapshotData<D>& data, const std::vector<typename D::Shape>& geometry) {
  WorldImplementation<D> trial(WorldDef<D>{});
  SnapshotReader<D> reader(data);
  visit_world(trial, reader);
  for (std::size_t i = 0; i < geometry.size(); ++i) trial.shapes.record[i].geometry = geometry[i];
  return StateCheck<D>(trial).run();
}

}  // namespace detail

template <class D>
void World<D>::snapshot(Snapshot<D>& into) {
  using namespace detail;
  if (into.self_ == nullptr) into.self_ = std::make_unique<SnapshotData<D>>();
  SnapshotData<D>& data = *into.self_;
  SnapshotWriter<D> writer(data);
  visit_world(static_cast<const WorldImplementation<D>&>(*self_), writer);
  if (self_->shapes.geometry_copy == nullptr) {
    auto copy = std::make_shared<std::vector<Shape>>();
    copy->reserve(self_->shapes.record.size());
    for (const ShapeRecord<D>& record : self_->shapes.record) copy->push_back(record.geometry);
    self_->shapes.geometry_copy = std::move(copy);
  }
  data.geometry = self_->shapes.geometry_copy;
  data.missing.clear();
  data.decoded = false;
  data.world_number = self_->world_number;
  data.step_count = self_->step_count;
}

template <class D>
Snapshot<D> World<D>::snapshot() {
  Snapshot<D> result;
  snapshot(result);
  return result;
}

template <class D>
Status World<D>::restore(const Snapshot<D>& snapshot) {
  using namespace detail;
  if (snapshot.empty()) return core::Error{"World::restore: the snapshot is empty, expected one that was taken"};
  const SnapshotData<D>& data = *snapshot.self_;
  WorldImplementation<D>& world = *self_;
  SnapshotChecker<D> checker(data);
  visit_world(static_cast<const WorldImplementation<D>&>(world), checker);
  if (!checker.fits())
    return core::Error{
        "World::restore: the snapshot's sections are not those of a world, expected one of this version"};
  const auto geometry = find_geometry(world, data);
  if (!geometry.ok()) return geometry.error();
  if (data.decoded)
    if (const Status sound = check_state<D>(data, **geometry); !sound.ok()) return sound;
  std::vector<EffectorData<D>> kept;  // the caller's own functions and surroundings, where bytes could not carry them
  for (std::size_t i = 0; i < data.effectors.size(); ++i) {
    if (!data.decoded || !lacks_own<D>(data.effectors[i].definition)) continue;
    const bool has_own = i < world.effectors.data.size() &&
                         world.effectors.data[i].definition.index() == data.effectors[i].definition.index() &&
                         !lacks_own<D>(world.effectors.data[i].definition);
    if (!has_own)
      return core::Error{core::text("World::restore: effector #", i + 1,
                                    " is the caller's own function or surroundings, which bytes do not carry, expected "
                                    "one in the same slot of this world")};
    if (kept.empty()) kept = world.effectors.data;
  }

  SnapshotReader<D> reader(data);
  visit_world(world, reader);
  if (world.shapes.geometry_copy == nullptr || world.shapes.geometry_copy != *geometry) {
    for (std::size_t i = 0; i < world.shapes.record.size(); ++i) world.shapes.record[i].geometry = (**geometry)[i];
    world.shapes.geometry_copy = *geometry;
  }
  for (std::size_t i = 0; i < world.effectors.data.size() && i < kept.size(); ++i) {
    EffectorDef<D>& here = world.effectors.data[i].definition;
    if (!lacks_own<D>(here)) continue;
    if (auto* custom = std::get_if<CustomEffector<D>>(&here)) {
      if (auto* own = std::get_if<CustomEffector<D>>(&kept[i].definition)) custom->model = own->model;
    } else if (std::holds_alternative<Surroundings<D>>(kept[i].definition)) {
      here = kept[i].definition;
    }
  }
  world.joints.trees.stale = true;
  world.shapes.terms.link();
  if (data.decoded || data.world_number != world.world_number) adopt_handles(world);
  world.scratch.watches.clear();  // they speak of other contacts
  world.scratch.swept.clear();
  world.scratch.old_bounds.clear();
  world.shapes.bounce = Bounce::unknown;
  return {};
}

}  // namespace carom::rigid
