// Particles by the million: structures of arrays of floats about an anchor in double, stepped in lanes (chapter 8).
// The same bits for any number of threads and any width.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/particles/air.h"
#include "carom/particles/burst.h"
#include "carom/particles/collider.h"
#include "carom/particles/contacts.h"
#include "carom/particles/curve.h"
#include "carom/particles/detail/aligned.h"
#include "carom/particles/detail/step_data.h"
#include "carom/particles/emitter.h"

namespace carom::particles {

/// All particles of a system are of one kind.
struct SystemDef {
  int capacity = 10'000;  ///< 1 … 2^24; fixed: what finds no room is not born
  bool planar = false;    ///< everything stays in the plane z = 0
  math::Vec3d anchor{};   ///< m: positions are floats about it, 0.06 mm fine at 1 km
  math::Vec3d gravity{0, -9.80665, 0};
  float gravity_scale = 1;  ///< hot smoke rises: < 0
  float radius = 0.01f;     ///< m, at scale 1
  float mass = 1e-3f;       ///< kg, at scale 1
  Drag drag{};
  Curve drag_over_age{};  ///< a factor of the drag
  // What is only looked at (`look`).
  Curve size_over_age{}, opacity_over_age{};
  Gradient color_over_age{};
  ContactDef contacts{};       ///< between particles
  bool report_deaths = false;  ///< `deaths` after each step
  bool report_hits = false;    ///< `hits` after each step
  float slowest_hit = 0.5f;    ///< m/s: slower impacts are not reported
  float limit = 1e6f;          ///< m and m/s: farther from the anchor or faster is lost
  int lanes = 0;               ///< 4, 8 or 16; 0: the widest of this machine
};

struct NewParticle {
  math::Vec3d position{};  ///< m
  math::Vec3d velocity{};  ///< m/s
  float lifetime = 1e30f;  ///< s
  float scale = 1;
};

/// A particle that died, or that hit something.
struct ParticleEvent {
  math::Vec3d position{};  ///< m
  math::Vec3f velocity{};  ///< m/s, after it
  math::Vec3f normal{};    ///< of the surface; zero for deaths
  float speed = 0;         ///< m/s of approach
  int collider = -1;
  std::uint32_t id = 0;
};

/// Particles born where others died or hit.
struct SubEmission {
  EmitterDef emitter{};      ///< its rate, burst and times do not count
  int count = 4;             ///< for each event
  float chance = 1;          ///< that an event counts
  float inherited = 0;       ///< the part of the event's velocity that they start with
  bool along_normal = true;  ///< the emitter's y is turned to the surface's normal
};

struct ParticleTotals {
  double mass = 0;              ///< kg
  math::Vec3d momentum{};       ///< kg·m/s
  math::Vec3d center{};         ///< m, of mass
  double kinetic_energy = 0;    ///< J
  double potential_energy = 0;  ///< J, in the system's gravity, zero at the anchor
};

class CAROM_API ParticleSystem {
 public:
  static core::Status check(const SystemDef& definition);
  static core::Result<ParticleSystem> create(const SystemDef& definition);

  const SystemDef& definition() const { return definition_; }
  int size() const { return count_; }
  double time() const { return time_; }
  void clear();

  /// False where there is no room. Errors: what is not finite, a lifetime or scale that is not above 0.
  core::Result<bool> add(const NewParticle& particle);
  /// Born at once, with `lifetime`; the centre's velocity is the burst's. Returns how many found room: an even number,
  /// so that the momentum of those that did is exact too.
  core::Result<int> burst(const BurstDef& definition, Range lifetime = {1e30f, 1e30f});
  /// Errors: a bad field. The number by which the emitter is named from now on.
  core::Result<int> add_emitter(const EmitterDef& definition);
  core::Status set_emitter(int emitter, const EmitterDef& definition);  ///< goes on with its clock and its draws
  const EmitterDef& emitter(int index) const { return emitters_[std::size_t(index)].definition; }
  int emitter_count() const { return int(emitters_.size()); }
  /// So many at once from an emitter, wherever its clock is; returns how many found room.
  core::Result<int> emit(int emitter, int count);
  /// Particles of this system for events of another one, or of itself. Returns how many were born.
  core::Result<int> emit_at(std::span<const ParticleEvent> events, const SubEmission& sub);

  core::Status set_air(const Air& air);
  core::Status set_attractors(std::span<const Attractor> attractors);
  core::Status set_gravity(math::Vec3d gravity);
  /// In force until set again. They are copied; shapes are shared.
  core::Status set_colliders(std::span<const Collider> colliders);
  std::span<const Collider> colliders() const { return colliders_; }

  /// Moves all by dt (0 < dt ≤ 1 s), then lets emitters bear. No allocation once warm.
  core::Status step(double dt, core::TaskScheduler* scheduler = nullptr);

  // What the last step told.
  std::span<const ParticleEvent> deaths() const { return deaths_; }
  std::span<const ParticleEvent> hits() const { return hits_; }
  std::span<const Exchange> exchanges() const { return exchanges_; }  ///< one a collider
  int lost() const { return lost_; }  ///< removed in all, because they left the limit or were no number
  double worst_overlap() const { return worst_overlap_; }  ///< of particles that touch, in radii, where contacts act

  // Reading; indices are good until the next step.
  math::Vec3d position(int i) const;
  math::Vec3d velocity(int i) const;
  math::Vec3d spin(int i) const;  ///< rad/s; zero unless contacts are enabled
  float age(int i) const;         ///< s
  float age_part(int i) const;    ///< 0 at birth … 1 at death
  float scale(int i) const { return arrays_[8][std::size_t(i)]; }
  std::uint32_t id(int i) const { return ids_[std::size_t(i)]; }  ///< rises with every birth
  /// The arrays themselves, `size()` long: 0 … 2 position about the anchor (m), 3 … 5 velocity (m/s).
  std::span<const float> array(int component) const { return {arrays_[component].data(), std::size_t(count_)}; }
  void set_velocity(int i, math::Vec3d velocity);
  /// New anchor; positions stay where they are in the world.
  void set_anchor(math::Vec3d anchor);

  ParticleTotals totals() const;
  std::uint64_t state_hash() const;
  /// How they look: positions in the world, radii and 0xRRGGBBAA by the curves over age, at most `most` of them, evenly
  /// picked. Keeps the vectors' memory.
  void look(std::vector<math::Vec3f>& positions, std::vector<float>& radii, std::vector<std::uint32_t>& rgbas,
            int most = 1 << 24) const;

 private:
  struct Emitter {
    EmitterDef definition;
    MeshAreas areas;
    math::Random random{0};
    double age = 0, owed = 0;
    bool burst_done = false;
  };
  explicit ParticleSystem(const SystemDef& definition);
  bool push(math::Vec3d position, math::Vec3d velocity, float birth, float lifetime, float scale);
  void bear(Emitter& emitter, double dt);
  bool bear_one(Emitter& emitter, double before_end);
  detail::Arrays pointers();
  void prepare_move(double dt);
  void prepare_wind(double time);
  void prepare_surfaces(double dt);
  void prepare_chunks();
  void run_chunk(int begin, int end, const detail::Kernels& kernels);
  int collide_block(int from, int to, detail::Path& path, detail::HitList& hits, double* exchanged,
                    const detail::Kernels& kernels);
  void cast_block(const detail::SurfaceData& surface, const geometry::Shape3& shape, int from, int to,
                  detail::Path& path) const;
  void find_surfaces(double dt, const detail::Kernels& kernels);
  void step_contacts(double dt, core::TaskScheduler& scheduler, const detail::Kernels& kernels);
  void place_grains(int from, int to, detail::Path& path);
  void distance_block(const detail::SurfaceData& surface, const geometry::Shape3& shape, float margin, int from, int to,
                      detail::Path& path) const;
  void collect_events();
  void remove_dead();
  void rebase_time();

  SystemDef definition_;
  int count_ = 0, lost_ = 0;
  double time_ = 0, epoch_ = 0;
  std::uint32_t next_id_ = 0;
  std::uint64_t sub_draws_ = 0;
  bool scaled_ = false, sticky_ = false;
  int lanes_ = 4;
  detail::AlignedFloats arrays_[10];  // position, velocity, birth, death (s after the epoch), scale, held
  detail::AlignedFloats spin_[3];     // rad/s, where particles touch each other
  std::vector<std::uint32_t> ids_;
  std::vector<Emitter> emitters_;
  Air air_;
  std::vector<Attractor> attractors_;
  std::vector<Collider> colliders_;
  detail::ContactSolver solver_;
  double worst_overlap_ = 0;

  // What a step needs.
  detail::MoveData move_{};
  detail::CollideData collide_{};
  std::vector<detail::Wave> wave_shapes_, waves_;
  std::vector<double> wave_rates_;
  std::vector<detail::WhirlData> whirl_data_;
  environment::WindPatch patch_;
  detail::AlignedFloats wind_nodes_;
  std::vector<detail::AttractorData> attractor_data_;
  std::vector<float> wind_table_, drag_table_;
  double wind_base_ = 0, wind_height_ = 1;  // m: where the table begins, and how high it is
  std::vector<detail::SurfaceData> surfaces_;
  std::vector<float> hull_planes_;
  std::vector<std::int32_t> dead_, chunk_dead_, chunk_hits_;
  std::vector<detail::Hit> hit_list_;
  std::vector<std::int32_t> hit_collider_;
  std::vector<double> chunk_exchanged_;
  std::vector<std::int32_t> chunk_touching_;
  std::vector<Exchange> exchanges_;
  std::vector<math::Vec3f> gained_, contact_centers_;
  std::vector<double> contact_exchanged_;
  std::vector<std::int32_t> contact_touching_;
  std::vector<ParticleEvent> deaths_, hits_;
};

}  // namespace carom::particles
