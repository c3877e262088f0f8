// Pairs of shapes whose bounds overlap, and the manifolds of those that touch.
#pragma once

#include <vector>

#include "carom/rigid/detail/constraint_graph.h"

namespace carom::rigid::detail {

enum ContactFlag : std::uint16_t {
  contact_touching = 1,  ///< surfaces met (an end event is due when they part), or, for sensors, overlap
  contact_sensor = 2,
  contact_many = 4,    ///< mesh, height field, compound or chain: several manifolds
  contact_events = 8,  ///< begin and end events wanted
  contact_hit_events = 16,
  contact_recycled = 32,  ///< `base` and the manifolds come from an earlier step
  contact_known = 64,     ///< `base`, `gap` and the manifolds are of a full update
  contact_in_use = 128,
  contact_round = 256,       ///< a sphere or circle takes part: always computed anew, it costs little
  contact_bouncy = 512,      ///< restitution of least_bounce at the least: looks ahead along the velocity
  contact_at_origin = 1024,  ///< both shapes stand unmoved in their bodies
  contact_special = 2048,    ///< one of the shapes has a ShapeExtra
  contact_decided = 4096,    ///< a one-way surface has decided on which side the other came
  contact_passing = 8192,    ///< and lets it through
  contact_on_disc = 16384,   ///< a cylinder or cone takes part: its patches may be discs
  contact_dynamic = 32768,   ///< both bodies are dynamic
};

/// In the plane, whose records are small, what a step touches of them lies in whole cache lines. Snapshots copy bytes:
/// none of them may be left to chance.
template <class D>
inline constexpr std::size_t record_alignment = D::dimension == 2 ? 64 : 4;
template <int Count>
struct RecordRest {
  float unused[Count] = {};
};
template <>
struct RecordRest<0> {};

/// A pair of shapes. `shape[0]` is A: normals point from it to B. What the solver's preparation reads comes first.
template <class D>
struct alignas(record_alignment<D>) ContactRecord {
  std::int32_t body[2] = {none, none};
  std::int32_t shape[2] = {none, none};
  std::uint16_t flags = 0;
  std::uint16_t manifold_count : 13 = 0;
  std::uint16_t rolls : 1 = 0;  ///< one of the shapes is round where it touches
  std::uint16_t small : 2 = 0;  ///< bits by side: the record of its shape ends with one or two numbers (is_small)
  std::int32_t first_manifold = none;
  std::int32_t awake_index = none;  ///< place in ContactStore::awake
  typename D::Transform base{};     ///< B in A when the manifolds were last computed in full
  float extent = 0;  ///< m: how far a turn of B by one radian about its middle (ball_about) moves its surface
  float inner = 0;   ///< m: half the thickness of the thinner shape
  float gap = 0;     ///< m: without manifolds, the shapes were at least this far apart at `base`
  std::int32_t next[2] = {none, none};  ///< edge keys (2·contact + side) in the lists of the bodies
  std::int32_t previous[2] = {none, none};
  typename D::Vector axis{};  ///< and, unless zero, that far along it (unit, in A's shape frame)
  geometry::PairCache cache{};
  [[no_unique_address]] RecordRest<D::dimension == 2 ? 10 : 0> rest;
  /// m: contacts up to this separation are of interest.
  float margin() const { return math::clamp(0.25f * inner, 0.001f, 0.02f); }
};
static_assert(sizeof(ContactRecord<Dim2>) == 128 && sizeof(ContactRecord<Dim3>) == 104);

/// What the solver did for a manifold, kept for warm starting, events and pictures.
template <class D>
struct ManifoldImpulses {
  float normal[D::max_points] = {};     ///< N·s, of the last substep
  float total[D::max_points] = {};      ///< N·s, over the last step
  typename D::Vector friction{};        ///< N·s on B, world axes, of the last substep
  typename D::Vector friction_total{};  ///< N·s on B over the last step
  typename D::Angular rolling{};        ///< N·m·s on B
  float twist = 0;                      ///< N·m·s about the normal (3D)
};

/// Whether friction remembers where it sticks. A new contact takes up its load later than gravity pulls; while it
/// settles, the way that it slips meanwhile is remembered and taken back.
enum class Anchor : std::uint8_t { none, holds, settles };

/// One patch of contact: a unit of the constraint graph. What every step reads and writes comes first.
template <class D>
struct alignas(record_alignment<D>) ManifoldRecord {
  std::int32_t contact = none;
  Anchor anchor = Anchor::none;
  bool disabled = false;  ///< pushes nothing in this step
  bool waits = false;     ///< its contact does not touch, and is watched until it bears a load
  std::uint8_t unused_too = 0;
  float friction = 0, restitution = 0, rolling_lever = 0, tangent_speed = 0;
  typename D::Manifold manifold{};            ///< in A's shape frame, at the contact's `base`
  typename D::Vector anchor_a{}, anchor_b{};  ///< where friction sticks: body frames, from the centres of mass
  ManifoldImpulses<D> impulses{};
  std::int32_t next = none;  ///< of the same contact
  GraphPlace place{};
  float approach_speed = 0;  ///< m/s at the start of the step, for hit events
  float slip_speed = 0;      ///< m/s across the surface at the start of the step, for hit events
  float spinning_lever = 0;  ///< m, of the torque about the normal (3D)
  [[no_unique_address]] RecordRest<D::dimension == 2 ? 9 : 0> rest;

  static constexpr std::size_t hot_bytes = D::dimension == 2 ? 128 : 256;
};
static_assert(sizeof(ManifoldRecord<Dim2>) == 192 && sizeof(ManifoldRecord<Dim3>) == 248);

template <class D>
struct ContactStore {
  core::Column<ContactRecord<D>> contacts;
  core::Column<ManifoldRecord<D>> manifolds;
  std::vector<std::int32_t> free_contacts, free_manifolds;
  std::vector<std::int32_t> awake;  ///< contacts with an awake body, updated every step
  int count = 0;

  ContactRecord<D>& at(std::int32_t i) { return contacts[std::size_t(i)]; }
  const ContactRecord<D>& at(std::int32_t i) const { return contacts[std::size_t(i)]; }
  ManifoldRecord<D>& manifold(std::int32_t i) { return manifolds[std::size_t(i)]; }
  const ManifoldRecord<D>& manifold(std::int32_t i) const { return manifolds[std::size_t(i)]; }
};

}  // namespace carom::rigid::detail
