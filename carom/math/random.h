// Random numbers from a counter: seeded, splittable into streams, the same on every platform, with no hidden state.
#pragma once

#include <array>
#include <cstdint>

#include "carom/export.h"
#include "carom/math/quat.h"

namespace carom::math {

/// Philox4x32-10 of Salmon, Moraes, Dror and Shaw, "Parallel random numbers: as easy as 1, 2, 3" (SC 2011): four random
/// words from a counter of 128 and a key of 64 bits.
CAROM_API std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

/// A generator. `seed` names an experiment and `stream` one of its 2⁶⁴ independent users (a body, an emitter, a
/// thread's share), so that what one draws does not depend on what another did. Copying copies the position.
class CAROM_API Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0) : seed_(seed), stream_(stream) {}

  std::uint32_t bits32();
  std::uint64_t bits64();
  /// Uniform in [0, n), every value equally likely (Lemire 2019). Zero where n is zero.
  std::uint32_t below(std::uint32_t n);
  /// Uniform in [low, high], both included; low where high < low.
  std::int32_t integer(std::int32_t low, std::int32_t high);
  /// Uniform in [0, 1), in steps of 2⁻²⁴ and 2⁻⁵³.
  float uniform_float();
  double uniform();
  /// Uniform in [low, high) up to rounding.
  float uniform(float low, float high);
  double uniform(double low, double high);
  /// True with probability p.
  bool chance(double p) { return uniform() < p; }
  /// Gaussian with mean zero and standard deviation one (Box and Muller 1958).
  double normal();
  double normal(double mean, double standard_deviation) { return mean + standard_deviation * normal(); }
  /// Time to the next event of a Poisson process of one event per unit time.
  double exponential();

  Vec2d on_circle();  ///< uniform on the unit circle
  Vec2d in_disc();    ///< uniform in the unit disc
  Vec3d on_sphere();  ///< uniform on the unit sphere (Archimedes: z is uniform)
  Vec3d in_sphere();  ///< uniform in the unit ball
  Quatd rotation();   ///< uniform over all attitudes (Shoemake 1992)

  /// A random order of items[0 … n−1] (Fisher and Yates).
  template <class Item>
  void shuffle(Item* items, std::uint32_t n) {
    for (std::uint32_t i = n; i > 1; --i) {
      const std::uint32_t j = below(i);
      Item t = static_cast<Item&&>(items[i - 1]);
      items[i - 1] = static_cast<Item&&>(items[j]);
      items[j] = static_cast<Item&&>(t);
    }
  }

  /// How many 32-bit words have been drawn, and a jump to any such position.
  std::uint64_t position() const { return position_; }
  void set_position(std::uint64_t position);
  std::uint64_t seed() const { return seed_; }
  std::uint64_t stream() const { return stream_; }
  friend bool operator==(const Random& a, const Random& b) {
    return a.seed_ == b.seed_ && a.stream_ == b.stream_ && a.position_ == b.position_;
  }

 private:
  std::uint64_t seed_, stream_, position_ = 0;
  std::array<std::uint32_t, 4> block_{};
};

}  // namespace carom::math
