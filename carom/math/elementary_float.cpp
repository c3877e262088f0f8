// The float functions: the double ones, rounded once more.
#include "carom/math/elementary.h"

namespace carom::math {

float sin(float x) { return static_cast<float>(sin(static_cast<double>(x))); }
float cos(float x) { return static_cast<float>(cos(static_cast<double>(x))); }
SinCos<float> sincos(float x) {
  const SinCos<double> r = sincos(static_cast<double>(x));
  return {static_cast<float>(r.sin), static_cast<float>(r.cos)};
}
float tan(float x) { return static_cast<float>(tan(static_cast<double>(x))); }
float asin(float x) { return static_cast<float>(asin(static_cast<double>(x))); }
float acos(float x) { return static_cast<float>(acos(static_cast<double>(x))); }
float atan(float x) { return static_cast<float>(atan(static_cast<double>(x))); }
float atan2(float y, float x) { return static_cast<float>(atan2(static_cast<double>(y), static_cast<double>(x))); }
float exp(float x) { return static_cast<float>(exp(static_cast<double>(x))); }
float exp2(float x) { return static_cast<float>(exp2(static_cast<double>(x))); }
float expm1(float x) { return static_cast<float>(expm1(static_cast<double>(x))); }
float log(float x) { return static_cast<float>(log(static_cast<double>(x))); }
float log2(float x) { return static_cast<float>(log2(static_cast<double>(x))); }
float log10(float x) { return static_cast<float>(log10(static_cast<double>(x))); }
float log1p(float x) { return static_cast<float>(log1p(static_cast<double>(x))); }
float pow(float x, float y) { return static_cast<float>(pow(static_cast<double>(x), static_cast<double>(y))); }
float cbrt(float x) { return static_cast<float>(cbrt(static_cast<double>(x))); }
float hypot(float x, float y) { return static_cast<float>(hypot(static_cast<double>(x), static_cast<double>(y))); }
float sinh(float x) { return static_cast<float>(sinh(static_cast<double>(x))); }
float cosh(float x) { return static_cast<float>(cosh(static_cast<double>(x))); }
float tanh(float x) { return static_cast<float>(tanh(static_cast<double>(x))); }
float fmod(float x, float y) { return static_cast<float>(fmod(static_cast<double>(x), static_cast<double>(y))); }

}  // namespace carom::math
