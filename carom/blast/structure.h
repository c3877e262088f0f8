// Things that break: parts held by bonds, one rigid body as long as they hold (chapter 18.8). After every step the
// blows that a body took are spread over its bonds; bonds that carry too much give way, and what no bond holds any more
// becomes a body of its own, with the velocity that it had as part of the whole.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "carom/blast/fracture.h"
#include "carom/blast/fracture2.h"
#include "carom/rigid/world.h"

namespace carom::blast {

/// What bonds bear, and how stiff they are.
struct BondMaterial {
  double tensile_strength = 3e6;      ///< Pa, > 0
  double compressive_strength = 3e7;  ///< Pa, > 0
  double shear_strength = 3e6;        ///< Pa, > 0
  double youngs_modulus = 3e10;       ///< Pa, > 0: only how it differs between bonds matters
  /// s: how long a blow lasts. A world's step tells the impulse of a blow, bonds feel impulse/time.
  double contact_time = 1e-3;
};
/// Numbers of common use, of the right size; measured ones scatter by half.
enum class Substance { glass, brick_and_mortar, concrete, ceramic, wood, ice };
CAROM_API BondMaterial bond_material(Substance substance);
CAROM_API double density_of(Substance substance);  ///< kg/m³

inline constexpr std::uint32_t ground = 0xffffffff;

template <class D>
struct StructureDef {
  struct Part {
    std::vector<typename D::Shape> shapes;  ///< about the centre, axes of the structure
    typename D::MassProperties mass;        ///< in the frame of the structure, about its centre
    std::uint32_t user_id = 0;              ///< of the shapes' material, 0: that of `shape`
  };
  struct Joint {
    std::uint32_t a = 0, b = 0;               ///< parts; b may be `ground`
    double area = 0;                          ///< m² (2D: m, a metre thick)
    typename D::Position center{}, normal{};  ///< in the frame of the structure; from a to b
    float strength = 1;                       ///< times the material's
  };
  std::vector<Part> parts;
  std::vector<Joint> bonds;
  BondMaterial material{};
  rigid::ShapeDef<D> shape{};              ///< of all shapes; density and local are set by the structure
  typename D::Pose pose{};                 ///< of the structure's frame
  typename D::Vector linear_velocity{};    ///< m/s, of the centre of mass
  typename D::Angular angular_velocity{};  ///< rad/s
  bool bullet_pieces = false;              ///< what breaks off is continuous against moving bodies too
  int iterations = 48;                     ///< of the solver for stresses, 1 … 1000
};
/// All pieces that have a hull, of one density (kg/m³, > 0). Mass of pieces without one goes to the neighbour with
/// which they share most; without a neighbour it is lost.
CAROM_API StructureDef<rigid::Dim3> structure_of(const Fracture& fracture, double density);
CAROM_API StructureDef<rigid::Dim2> structure_of(const Fracture2& fracture, double density);
/// Bonds to the ground for parts with corners below `level` (m, in the structure's frame, along y): area by the extent
/// of the part there.
CAROM_API void anchor_below(StructureDef<rigid::Dim3>& definition, double level);
CAROM_API void anchor_below(StructureDef<rigid::Dim2>& definition, double level);

/// What happened in a step.
template <class D>
struct BreakEvent {
  std::uint32_t bond = 0;
  double load = 0;  ///< stress by strength
};

/// A structure in a world. Copy it with a snapshot of the world, and restore both.
template <class D>
class CAROM_API Structure {
 public:
  using World = rigid::World<D>;
  using Vector = typename D::Vector;
  using Position = typename D::Position;

  Structure() = default;
  /// Makes the bodies. Errors: no part, a part without shape or mass, bonds to parts that do not exist or without area,
  /// numbers out of range, what the world refuses.
  static core::Result<Structure> make(World& world, const StructureDef<D>& definition);

  /// After each step of `dt` s: breaks what must. A FractureStepper in place of World::step does better where things
  /// strike fast: here the step is over when the bonds break. Of a blow that broke bonds of what stands on the ground,
  /// what they could not bear is given back to the striker, which meets the loose parts in the next step; a free body
  /// keeps what the blow made of it.
  core::Status after_step(World& world, float dt);
  /// A load besides what touches: an impulse (N·s, at a point of the world) that acted within `duration` s on a part.
  /// It counts in the next after_step; the body has to be told of it by someone else (an Explosion does).
  void add_load(std::uint32_t part, Vector impulse, Position point, double duration);

  // What a FractureStepper does, one by one, for loops with other models in them. A step: start_step; snapshot; the
  // world's step; find_breaks. Where that says true: restore, bear, part_bodies, and from the snapshot again; else
  // part_bodies.
  void start_step();       ///< forgets the events of the last one
  bool can_break() const;  ///< some bond still holds something
  /// Breaks bonds by what the last step of the world did. True: contacts broke some, and parts came off.
  core::Result<bool> find_breaks(World& world, float dt);
  /// On the world as it was before that step: takes from strikers what the bonds bore.
  core::Status bear(World& world);
  /// Instead, where the step is not done again: what bonds to the ground could not bear goes back to the strikers.
  core::Status give_back(World& world);
  /// Makes bodies of what came off.
  core::Status part_bodies(World& world);

  /// The part that a shape is of, or `ground` (none).
  std::uint32_t part_of(rigid::ShapeId shape) const;
  rigid::BodyId body_of(std::uint32_t part) const { return clusters_[cluster_of_[part]].body; }
  /// Where the origin of a part's body is, in the structure's frame (whose axes the body keeps).
  Position origin_of(std::uint32_t part) const { return clusters_[cluster_of_[part]].origin; }
  std::size_t part_count() const { return cluster_of_.size(); }
  std::size_t cluster_count() const { return clusters_.size(); }
  bool holds(std::uint32_t bond) const { return intact_[bond] != 0; }
  std::size_t broken() const { return broken_; }
  std::span<const BreakEvent<D>> events() const { return events_; }  ///< bonds that broke in the last after_step
  /// Bodies that the last after_step made: for who shows them.
  std::span<const rigid::BodyId> made() const { return made_; }
  /// Bodies that lost parts in the last after_step, or are gone.
  std::span<const rigid::BodyId> changed() const { return changed_; }
  const StructureDef<D>& definition() const { return *definition_; }
  /// Greatest stress by strength of each bond when it was last computed.
  std::span<const float> loads() const { return bond_loads_; }
  /// Breaks a bond by hand; it counts in the next after_step.
  void break_bond(std::uint32_t bond);

 private:
  struct Cluster {
    rigid::BodyId body{};
    Position origin{};  // of the body, in the structure's frame
    std::vector<std::uint32_t> parts;
    bool fixed = false;
    bool stale = true;        // topology or loads not looked at yet
    double resting_load = 0;  // N, sum when last looked at
  };
  struct ShapeOf {
    std::uint32_t index;
    rigid::ShapeId shape;
    std::uint32_t part;
  };
  struct Load {
    std::uint32_t part;
    Vector impulse;
    Position point;
    double duration;
  };
  /// Of a contact, over the step that was done.
  struct Blow {
    std::uint32_t cluster = 0, part = 0;
    Position point{};
    Position impulse{};  // N·s, on the cluster
    double duration = 0;
    rigid::BodyId striker{};
    double approach_speed = 0;              // m/s, 0: it was there before
    double kept = 1;                        // what the bonds bore of it
    Position cluster_arm{}, striker_arm{};  // m, of the point about the centres of mass
  };
  core::Status make_body(World& world, Cluster& cluster, const typename D::Pose& frame, Vector velocity,
                         typename D::Angular spin);
  core::Status split(World& world, std::uint32_t cluster);
  bool look_at(World& world, std::uint32_t cluster, float dt);
  bool collect_blows(World& world, std::uint32_t cluster, float dt);
  /// Worst stress by strength that had to be passed for parts to come off; 0: none did.
  double break_bonds(World& world, std::uint32_t cluster);

  std::shared_ptr<const StructureDef<D>> definition_;
  std::vector<std::uint32_t> cluster_of_;
  std::vector<Cluster> clusters_;
  std::vector<ShapeOf> shapes_;  // by index of the handle
  std::vector<std::uint8_t> intact_;
  std::vector<float> bond_loads_;
  std::vector<Load> loads_;
  std::vector<BreakEvent<D>> events_;
  std::vector<rigid::BodyId> made_, changed_;
  std::vector<std::uint32_t> apart_;             // of the step
  std::vector<Blow> blows_;                      // of the step; those of the cluster that is looked at come last
  std::vector<rigid::ContactView<D>> contacts_;  // scratch
  std::vector<rigid::BodyId> struck_;            // scratch: what hits were told of
  std::size_t broken_ = 0;
};

/// World::step for worlds with structures in them: where a blow breaks bonds it goes back to before the step, takes
/// from the striker what the bonds bore, lets go what they no longer hold, and does the step again, so that the striker
/// meets loose parts at its time and with the speed that it has left. Momentum and angular momentum are kept (what
/// stands on the ground gives its share to the ground), energy is never won. What acts before the step (forces,
/// impulses) is done again with it; CustomEffectors with a state of their own are asked again.
template <class D>
class CAROM_API FractureStepper {
 public:
  FractureStepper() = default;
  FractureStepper(const FractureStepper&) {}  // there is nothing to copy but memory
  FractureStepper& operator=(const FractureStepper&) { return *this; }

  /// Does what World::step(dt) and after_step of all the structures do. Where the world is left after an error is its
  /// state before the step or after it.
  core::Status step(rigid::World<D>& world, float dt, std::span<Structure<D>* const> structures);
  core::Status step(rigid::World<D>& world, float dt, Structure<D>& structure) {
    Structure<D>* const one = &structure;
    return step(world, dt, std::span(&one, 1));
  }
  /// How often the last step was done: 1 where nothing broke.
  int rounds() const { return rounds_; }
  static constexpr int most_rounds = 12;  ///< then what is left acts in the next step

 private:
  rigid::Snapshot<D> before_;
  int rounds_ = 0;
};

extern template class CAROM_API Structure<rigid::Dim2>;
extern template class CAROM_API Structure<rigid::Dim3>;
extern template class CAROM_API FractureStepper<rigid::Dim2>;
extern template class CAROM_API FractureStepper<rigid::Dim3>;
using Structure2 = Structure<rigid::Dim2>;
using Structure3 = Structure<rigid::Dim3>;
using FractureStepper2 = FractureStepper<rigid::Dim2>;
using FractureStepper3 = FractureStepper<rigid::Dim3>;

}  // namespace carom::blast
