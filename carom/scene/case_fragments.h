// The case of a charge of a scene: thrown as fragments when it goes off, which fly and hit as projectiles do.
#pragma once

#include "carom/ballistics/batch.h"
#include "carom/blast/fragments.h"
#include "carom/core/hash.h"

namespace carom::scene {

struct CaseDef {
  double mass = 1;  ///< kg
  blast::CaseShape shape = blast::CaseShape::sphere;
  double gurney_constant = blast::gurney_tnt;  ///< m/s
  int fragments = 500;                         ///< 2 … 100 000; rounded up to an even number
  double density = 7850;                       ///< kg/m³
  double drag_coefficient = 1.1;               ///< of tumbling chunks
  double lifetime = 10;                        ///< s that they fly at most
  std::uint64_t seed = 1;
};
/// Errors name a field that cannot be, by the names of scene files.
CAROM_API core::Status check(const CaseDef& definition);

class CAROM_API CaseFragments {
 public:
  CaseFragments(const CaseDef& definition, const ballistics::Conditions& conditions);
  /// Speeds by Gurney and masses by Mott, with no momentum between them, from a case that moves with `velocity` about
  /// a charge of `charge` kg, at `time` (s).
  core::Status fly_apart(math::Vec3d place, math::Vec3d velocity, double charge, double time);
  /// None is left once their lifetime is over.
  void forget_old(double now);
  bool thrown() const { return thrown_; }
  const CaseDef& definition() const { return definition_; }
  ballistics::ProjectileBatch& batch() { return batch_; }
  const ballistics::ProjectileBatch& batch() const { return batch_; }
  int hits = 0;  ///< bodies that they met so far, each meeting counted
  void add_to(core::StateHash& hash) const;

 private:
  CaseDef definition_;
  ballistics::ProjectileBatch batch_;
  double thrown_at_ = 0;  // s
  bool thrown_ = false;
};

}  // namespace carom::scene
