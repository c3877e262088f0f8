// Elementary functions with the same bits on every compiler and machine.
//
// Nothing here calls the C library. Every function is a fixed sequence of IEEE additions, multiplications, divisions
// and square roots on doubles; polynomials are minimax fits of our own (tools/fit_elementary.py). Special values
// (zeros, infinities, NaN, poles, domain errors) give what C99 annex F gives, but no errno and no promise about
// exception flags. Errors are in units in the last place of the result (ulp), as bounds that tests/math measures
// against MPFR.
#pragma once

#include "carom/export.h"

namespace carom::math {

template <class T>
struct SinCos {
  T sin, cos;
};

// Double. All arguments, of any size: angles are reduced by 2/π with as many digits as the argument needs.
CAROM_API double sin(double x);             ///< x in rad; error < 0.9 ulp.
CAROM_API double cos(double x);             ///< x in rad; error < 0.9 ulp.
CAROM_API SinCos<double> sincos(double x);  ///< The bits of sin(x) and cos(x), with one reduction.
CAROM_API double tan(double x);             ///< x in rad; error < 1 ulp.
CAROM_API double asin(double x);            ///< rad in [−π/2, π/2]; NaN outside [−1, 1]; error < 0.6 ulp.
CAROM_API double acos(double x);            ///< rad in [0, π]; NaN outside [−1, 1]; error < 0.6 ulp.
CAROM_API double atan(double x);            ///< rad in [−π/2, π/2]; error < 0.6 ulp.
/// The angle of the point (x, y), rad in [−π, π], with the signs of zeros and infinities as C99; error < 0.6 ulp.
CAROM_API double atan2(double y, double x);
CAROM_API double exp(double x);    ///< Error < 0.55 ulp (1 ulp where the result is subnormal).
CAROM_API double exp2(double x);   ///< 2ˣ; error < 0.55 ulp (1 ulp where the result is subnormal).
CAROM_API double expm1(double x);  ///< eˣ − 1 without cancellation; error < 0.75 ulp.
CAROM_API double log(double x);    ///< −∞ at zero, NaN below; error < 0.55 ulp.
CAROM_API double log2(double x);   ///< −∞ at zero, NaN below; error < 0.55 ulp.
CAROM_API double log10(double x);  ///< −∞ at zero, NaN below; error < 0.55 ulp.
CAROM_API double log1p(double x);  ///< ln(1 + x) without cancellation; error < 0.6 ulp.
/// xʸ with the special values of C99 F.9.4.4; error < 0.6 ulp (1 ulp where the result is subnormal).
CAROM_API double pow(double x, double y);
CAROM_API double cbrt(double x);             ///< Error < 0.55 ulp.
CAROM_API double hypot(double x, double y);  ///< √(x² + y²) without overflow or underflow; error < 0.55 ulp.
CAROM_API double sinh(double x);             ///< Error < 0.6 ulp.
CAROM_API double cosh(double x);             ///< Error < 0.6 ulp.
CAROM_API double tanh(double x);             ///< Error < 0.6 ulp.
/// The remainder of x / y with the sign of x, exact (C99 fmod). NaN where y is zero or x is infinite.
CAROM_API double fmod(double x, double y);

// Float: computed in double and rounded once; error < 0.501 ulp.
CAROM_API float sin(float x);
CAROM_API float cos(float x);
CAROM_API SinCos<float> sincos(float x);
CAROM_API float tan(float x);
CAROM_API float asin(float x);
CAROM_API float acos(float x);
CAROM_API float atan(float x);
CAROM_API float atan2(float y, float x);
CAROM_API float exp(float x);
CAROM_API float exp2(float x);
CAROM_API float expm1(float x);
CAROM_API float log(float x);
CAROM_API float log2(float x);
CAROM_API float log10(float x);
CAROM_API float log1p(float x);
CAROM_API float pow(float x, float y);
CAROM_API float cbrt(float x);
CAROM_API float hypot(float x, float y);
CAROM_API float sinh(float x);
CAROM_API float cosh(float x);
CAROM_API float tanh(float x);
CAROM_API float fmod(float x, float y);

// Exact, correctly rounded, and the same everywhere.
inline double floor(double x) { return __builtin_floor(x); }
inline float floor(float x) { return __builtin_floorf(x); }
inline double ceil(double x) { return __builtin_ceil(x); }
inline float ceil(float x) { return __builtin_ceilf(x); }
inline double trunc(double x) { return __builtin_trunc(x); }
inline float trunc(float x) { return __builtin_truncf(x); }
/// Halfway cases away from zero.
inline double round(double x) { return __builtin_round(x); }
inline float round(float x) { return __builtin_roundf(x); }
inline double copysign(double magnitude, double sign) { return __builtin_copysign(magnitude, sign); }
inline float copysign(float magnitude, float sign) { return __builtin_copysignf(magnitude, sign); }

}  // namespace carom::math
