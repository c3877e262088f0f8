#include "carom/math/random.h"

#include "carom/math/elementary.h"

namespace carom::math {

std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> c, std::array<std::uint32_t, 2> k) {
  for (int round = 0; round < 10; ++round) {
    const std::uint64_t a = std::uint64_t{0xD2511F53u} * c[0], b = std::uint64_t{0xCD9E8D57u} * c[2];
    c = {static_cast<std::uint32_t>(b >> 32) ^ c[1] ^ k[0], static_cast<std::uint32_t>(b),
         static_cast<std::uint32_t>(a >> 32) ^ c[3] ^ k[1], static_cast<std::uint32_t>(a)};
    k = {k[0] + 0x9E3779B9u, k[1] + 0xBB67AE85u};
  }
  return c;
}

std::uint32_t Random::bits32() {
  const std::uint32_t lane = static_cast<std::uint32_t>(position_ & 3);
  if (lane == 0) set_position(position_);
  ++position_;
  return block_[lane];
}

void Random::set_position(std::uint64_t position) {
  position_ = position;
  const std::uint64_t block = position >> 2;
  block_ = philox({static_cast<std::uint32_t>(block), static_cast<std::uint32_t>(block >> 32),
                   static_cast<std::uint32_t>(stream_), static_cast<std::uint32_t>(stream_ >> 32)},
                  {static_cast<std::uint32_t>(seed_), static_cast<std::uint32_t>(seed_ >> 32)});
}

std::uint64_t Random::bits64() {
  const std::uint64_t low = bits32();
  const std::uint64_t high = bits32();
  return high << 32 | low;
}

std::uint32_t Random::below(std::uint32_t n) {
  std::uint64_t m = std::uint64_t{bits32()} * n;
  if (static_cast<std::uint32_t>(m) < n) {
    const std::uint32_t unfair = (0u - n) % n;  // 2³² mod n
    while (static_cast<std::uint32_t>(m) < unfair) m = std::uint64_t{bits32()} * n;
  }
  return static_cast<std::uint32_t>(m >> 32);
}

std::int32_t Random::integer(std::int32_t low, std::int32_t high) {
  if (high <= low) return low;
  const std::uint32_t span = static_cast<std::uint32_t>(high) - static_cast<std::uint32_t>(low) + 1;
  const std::uint32_t offset = span == 0 ? bits32() : below(span);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(low) + offset);
}

float Random::uniform_float() { return static_cast<float>(bits32() >> 8) * 0x1p-24f; }
double Random::uniform() { return static_cast<double>(bits64() >> 11) * 0x1p-53; }
float Random::uniform(float low, float high) { return low + (high - low) * uniform_float(); }
double Random::uniform(double low, double high) { return low + (high - low) * uniform(); }

double Random::normal() {
  const double u = 1 - uniform(), v = uniform();
  return sqrt(-2 * log(u)) * cos(2 * pi * v);
}

double Random::exponential() { return -log(1 - uniform()); }

Vec2d Random::on_circle() {
  const SinCos<double> a = sincos(2 * pi * uniform());
  return {a.cos, a.sin};
}

Vec2d Random::in_disc() {
  const double r = sqrt(uniform());
  return r * on_circle();
}

Vec3d Random::on_sphere() {
  const double z = uniform(-1.0, 1.0), r = sqrt(max(0.0, (1 - z) * (1 + z)));
  const Vec2d c = on_circle();
  return {r * c.x, r * c.y, z};
}

Vec3d Random::in_sphere() {
  const double r = cbrt(uniform());
  return r * on_sphere();
}

Quatd Random::rotation() {
  const double u = uniform();
  const Vec2d a = sqrt(1 - u) * on_circle();
  const Vec2d b = sqrt(u) * on_circle();
  return {a.x, a.y, b.x, b.y};
}

}  // namespace carom::math
