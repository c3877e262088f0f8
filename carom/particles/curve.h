// What changes over a particle's age: a number or a colour, linear between keys.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <span>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::particles {

struct CurveKey {
  float age = 0;  ///< 0 at birth, 1 at death
  float value = 1;
};

/// A number over the age, kept as 64 equal pieces.
class CAROM_API Curve {
 public:
  static constexpr int pieces = 64;
  explicit Curve(float constant = 1);
  /// Errors: no key, one that is not finite or has an age outside 0 … 1, ages that fall.
  static core::Result<Curve> make(std::span<const CurveKey> keys);
  static core::Result<Curve> make(std::initializer_list<CurveKey> keys) {
    return make(std::span<const CurveKey>(keys.begin(), keys.size()));
  }
  float operator()(float age) const {
    const float place = (age > 0 ? (age < 1 ? age : 1) : 0) * float(pieces);
    const int i = place < float(pieces) ? int(place) : pieces - 1;
    return values_[i] + (place - float(i)) * (values_[i + 1] - values_[i]);
  }
  bool is_constant() const { return constant_; }
  const std::array<float, pieces + 1>& values() const { return values_; }

 private:
  std::array<float, pieces + 1> values_{};
  bool constant_ = true;
};

struct ColorKey {
  float age = 0;                 ///< 0 at birth, 1 at death
  std::uint32_t rgb = 0xffffff;  ///< 0xRRGGBB
};

/// A colour over the age, mixed in the components as they are given.
class CAROM_API Gradient {
 public:
  explicit Gradient(std::uint32_t rgb = 0xffffff);
  /// Errors as of Curve, and a colour of more than 24 bits.
  static core::Result<Gradient> make(std::span<const ColorKey> keys);
  static core::Result<Gradient> make(std::initializer_list<ColorKey> keys) {
    return make(std::span<const ColorKey>(keys.begin(), keys.size()));
  }
  std::uint32_t operator()(float age) const;  ///< 0xRRGGBB

 private:
  Curve channel_[3];
};

}  // namespace carom::particles
