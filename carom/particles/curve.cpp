#include "carom/particles/curve.h"

#include <string>

#include "carom/math/vec.h"

namespace carom::particles {
namespace {

template <class Key>
core::Status check_keys(const char* what, std::span<const Key> keys) {
  if (keys.empty()) return core::Error{std::string(what) + ": no keys, at least one was expected"};
  float last = 0;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!(keys[i].age >= last && keys[i].age <= 1))
      return core::Error{std::string(what) + ": age of key " + std::to_string(i) + " is " +
                         std::to_string(keys[i].age) + ", expected 0 to 1 and not below the one before"};
    last = keys[i].age;
  }
  return {};
}

}  // namespace

Curve::Curve(float constant) { values_.fill(constant); }

core::Result<Curve> Curve::make(std::span<const CurveKey> keys) {
  if (const core::Status status = check_keys("curve", keys); !status) return status.error();
  for (std::size_t i = 0; i < keys.size(); ++i)
    if (!math::is_finite(keys[i].value))
      return core::Error{"curve: value of key " + std::to_string(i) + " is not finite"};
  Curve curve;
  std::size_t k = 0;
  for (int i = 0; i <= pieces; ++i) {
    const float age = float(i) / float(pieces);
    while (k + 1 < keys.size() && keys[k + 1].age <= age) ++k;
    float value = keys[k].value;
    if (age > keys[k].age && k + 1 < keys.size())
      value = math::lerp(value, keys[k + 1].value, (age - keys[k].age) / (keys[k + 1].age - keys[k].age));
    curve.values_[std::size_t(i)] = value;
    curve.constant_ = curve.constant_ && value == curve.values_[0];
  }
  return curve;
}

Gradient::Gradient(std::uint32_t rgb) {
  for (int c = 0; c < 3; ++c) channel_[c] = Curve(float(rgb >> (16 - 8 * c) & 0xff));
}

core::Result<Gradient> Gradient::make(std::span<const ColorKey> keys) {
  if (const core::Status status = check_keys("gradient", keys); !status) return status.error();
  Gradient gradient;
  std::array<CurveKey, 32> channel{};
  if (keys.size() > channel.size())
    return core::Error{"gradient: " + std::to_string(keys.size()) + " keys, at most 32 were expected"};
  for (int c = 0; c < 3; ++c) {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      if (keys[i].rgb > 0xffffff)
        return core::Error{"gradient: rgb of key " + std::to_string(i) + " is " + std::to_string(keys[i].rgb) +
                           ", expected 0xRRGGBB"};
      channel[i] = {keys[i].age, float(keys[i].rgb >> (16 - 8 * c) & 0xff)};
    }
    core::Result<Curve> curve = Curve::make(std::span<const CurveKey>(channel.data(), keys.size()));
    if (!curve) return curve.error();
    gradient.channel_[c] = *curve;
  }
  return gradient;
}

std::uint32_t Gradient::operator()(float age) const {
  std::uint32_t rgb = 0;
  for (const Curve& c : channel_) rgb = rgb << 8 | std::uint32_t(math::clamp(c(age) + 0.5f, 0.0f, 255.0f));
  return rgb;
}

}  // namespace carom::particles
