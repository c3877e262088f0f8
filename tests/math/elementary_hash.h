// One number for the bits of all elementary functions over a fixed sample: equal on gcc, clang and WASM.
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>

#include "carom/math/elementary.h"

namespace carom::test {

/// FNV-1a over the results' bits, a word at a time; a NaN counts as one fixed word, because its payload is not
/// promised.
inline std::uint64_t elementary_hash() {
  std::uint64_t hash = 0xcbf29ce484222325ULL, state = 0x9e3779b97f4a7c15ULL;
  const auto add = [&](double v) {
    hash = (hash ^ (v == v ? std::bit_cast<std::uint64_t>(v) : 0x7ff8000000000000ULL)) * 0x100000001b3ULL;
    hash ^= hash >> 29;
  };
  const auto next = [&] {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state * 0x2545f4914f6cdd1dULL;
  };
  const auto unary = [&](double x) {
    using namespace carom::math;
    for (double (*f)(double) : {static_cast<double (*)(double)>(sin), static_cast<double (*)(double)>(cos),
                                static_cast<double (*)(double)>(tan), static_cast<double (*)(double)>(asin),
                                static_cast<double (*)(double)>(acos), static_cast<double (*)(double)>(atan),
                                static_cast<double (*)(double)>(exp), static_cast<double (*)(double)>(exp2),
                                static_cast<double (*)(double)>(expm1), static_cast<double (*)(double)>(log),
                                static_cast<double (*)(double)>(log2), static_cast<double (*)(double)>(log10),
                                static_cast<double (*)(double)>(log1p), static_cast<double (*)(double)>(cbrt),
                                static_cast<double (*)(double)>(sinh), static_cast<double (*)(double)>(cosh),
                                static_cast<double (*)(double)>(tanh)}) {
      add(f(x));
    }
  };
  for (int i = 0; i < 20000; ++i) {
    const std::uint64_t a = next(), b = next();
    const double any = std::bit_cast<double>(a);                                   // every exponent, NaN included
    const double x = static_cast<double>(static_cast<std::int64_t>(b)) * 0x1p-60;  // −8 … 8
    const double y = static_cast<double>(static_cast<std::int64_t>(a)) * 0x1p-63;  // −1 … 1
    unary(any);
    unary(x);
    unary(y);
    add(math::pow(x < 0 ? -x : x, 40 * y));
    add(math::atan2(y, x));
    add(math::hypot(x, any));
    add(math::fmod(any, x));
    const float narrow = static_cast<float>(x);
    add(static_cast<double>(math::sin(narrow)));
    add(static_cast<double>(math::exp(narrow)));
    add(static_cast<double>(math::atan2(narrow, 0.5f)));
  }
  return hash;
}

}  // namespace carom::test
