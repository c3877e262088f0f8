// Compile-time dimensioned quantities for user code: adding a length to a time does not compile.
//
//   using namespace carom::math::literals;
//   const auto speed = 30.0_mph;                 // Speed
//   const auto distance = speed * 2.5_s;         // Length
//   body.linear_velocity.x = speed.si();         // the library itself takes plain SI numbers
//   speed.in(1.0_kn);                            // 26.07…
#pragma once

#include <cstdint>

#include "carom/math/units.h"
#include "carom/math/vec.h"

namespace carom::math {

/// A number of kg^M m^L s^T K^Θ A^I, kept in SI. Costs no more than the double inside. Where all dimensions cancel, the
/// operators give a plain double.
template <int M, int L, int T, int Theta = 0, int I = 0>
class Quantity {
  static_assert((M | L | T | Theta | I) != 0, "a quantity without dimension is a double");

 public:
  constexpr Quantity() = default;
  static constexpr Quantity from_si(double value) { return Quantity(value); }
  constexpr double si() const { return si_; }
  /// How many of `unit` this is.
  constexpr double in(Quantity unit) const { return si_ / unit.si_; }
  static constexpr Dimension dimension() { return {M, L, T, Theta, I}; }

  constexpr Quantity& operator+=(Quantity b) {
    si_ += b.si_;
    return *this;
  }
  constexpr Quantity& operator-=(Quantity b) {
    si_ -= b.si_;
    return *this;
  }
  constexpr Quantity& operator*=(double s) {
    si_ *= s;
    return *this;
  }
  constexpr Quantity& operator/=(double s) {
    si_ /= s;
    return *this;
  }
  friend constexpr Quantity operator+(Quantity a, Quantity b) { return Quantity(a.si_ + b.si_); }
  friend constexpr Quantity operator-(Quantity a, Quantity b) { return Quantity(a.si_ - b.si_); }
  friend constexpr Quantity operator-(Quantity a) { return Quantity(-a.si_); }
  friend constexpr Quantity operator*(double s, Quantity a) { return Quantity(s * a.si_); }
  friend constexpr Quantity operator*(Quantity a, double s) { return Quantity(a.si_ * s); }
  friend constexpr Quantity operator/(Quantity a, double s) { return Quantity(a.si_ / s); }
  friend constexpr bool operator==(Quantity a, Quantity b) { return a.si_ == b.si_; }
  friend constexpr bool operator<(Quantity a, Quantity b) { return a.si_ < b.si_; }
  friend constexpr bool operator>(Quantity a, Quantity b) { return a.si_ > b.si_; }
  friend constexpr bool operator<=(Quantity a, Quantity b) { return a.si_ <= b.si_; }
  friend constexpr bool operator>=(Quantity a, Quantity b) { return a.si_ >= b.si_; }

 private:
  constexpr explicit Quantity(double value) : si_(value) {}
  double si_{};
};

namespace detail {
template <int M, int L, int T, int Theta, int I>
constexpr auto quantity_of(double si) {
  if constexpr ((M | L | T | Theta | I) == 0) {
    return si;
  } else {
    return Quantity<M, L, T, Theta, I>::from_si(si);
  }
}
}  // namespace detail

template <int M, int L, int T, int Theta, int I, int M2, int L2, int T2, int Theta2, int I2>
constexpr auto operator*(Quantity<M, L, T, Theta, I> a, Quantity<M2, L2, T2, Theta2, I2> b) {
  return detail::quantity_of<M + M2, L + L2, T + T2, Theta + Theta2, I + I2>(a.si() * b.si());
}
template <int M, int L, int T, int Theta, int I, int M2, int L2, int T2, int Theta2, int I2>
constexpr auto operator/(Quantity<M, L, T, Theta, I> a, Quantity<M2, L2, T2, Theta2, I2> b) {
  return detail::quantity_of<M - M2, L - L2, T - T2, Theta - Theta2, I - I2>(a.si() / b.si());
}
template <int M, int L, int T, int Theta, int I>
constexpr auto operator/(double a, Quantity<M, L, T, Theta, I> b) {
  return Quantity<-M, -L, -T, -Theta, -I>::from_si(a / b.si());
}
/// The root of a quantity whose exponents are even.
template <int M, int L, int T, int Theta, int I>
inline auto sqrt(Quantity<M, L, T, Theta, I> a) {
  static_assert(M % 2 == 0 && L % 2 == 0 && T % 2 == 0 && Theta % 2 == 0 && I % 2 == 0, "the exponents must be even");
  return Quantity<M / 2, L / 2, T / 2, Theta / 2, I / 2>::from_si(math::sqrt(a.si()));
}

using Mass = Quantity<1, 0, 0>;
using Length = Quantity<0, 1, 0>;
using Time = Quantity<0, 0, 1>;
using Temperature = Quantity<0, 0, 0, 1>;
using Current = Quantity<0, 0, 0, 0, 1>;
using Area = Quantity<0, 2, 0>;
using Volume = Quantity<0, 3, 0>;
using Speed = Quantity<0, 1, -1>;
using Acceleration = Quantity<0, 1, -2>;
using Frequency = Quantity<0, 0, -1>;
using Force = Quantity<1, 1, -2>;
using Energy = Quantity<1, 2, -2>;
using Power = Quantity<1, 2, -3>;
using Pressure = Quantity<1, -1, -2>;
using Density = Quantity<1, -3, 0>;
using Momentum = Quantity<1, 1, -1>;
using MomentOfInertia = Quantity<1, 2, 0>;

namespace detail {

// Not constexpr on purpose: reaching one in a literal is a compile error that names the reason.
inline void a_quantity_literal_has_decimal_digits_and_an_exponent_only() {}
inline void a_quantity_literal_has_at_most_15_digits_and_an_exponent_within_22() {}

/// The value of a decimal literal. Read from its characters, because long double differs between platforms.
consteval double literal_value(const char* text) {
  double mantissa = 0, power = 1;
  int digits = 0, exponent = 0;
  bool point = false;
  for (; *text != '\0' && *text != 'e' && *text != 'E'; ++text) {
    if (*text == '\'') continue;
    if (*text == '.' && !point) {
      point = true;
      continue;
    }
    if (*text < '0' || *text > '9') a_quantity_literal_has_decimal_digits_and_an_exponent_only();
    mantissa = 10 * mantissa + (*text - '0');
    if (mantissa != 0) ++digits;
    if (point) --exponent;
  }
  if (*text != '\0') {
    ++text;
    const bool negative = *text == '-';
    if (*text == '-' || *text == '+') ++text;
    int e = 0;
    for (; *text != '\0'; ++text) e = 10 * e + (*text - '0');
    exponent += negative ? -e : e;
  }
  if (digits > 15 || exponent < -22 || exponent > 22) {
    a_quantity_literal_has_at_most_15_digits_and_an_exponent_within_22();
  }
  for (int i = exponent < 0 ? -exponent : exponent; i > 0; --i) power *= 10;
  return exponent < 0 ? mantissa / power : mantissa * power;
}

}  // namespace detail

namespace literals {

#define CAROM_QUANTITY_LITERAL(suffix, type, factor) \
  consteval type operator""_##suffix(const char* text) { return type::from_si(detail::literal_value(text) factor); }
CAROM_QUANTITY_LITERAL(kg, Mass, )
CAROM_QUANTITY_LITERAL(gram, Mass, / 1000)
CAROM_QUANTITY_LITERAL(tonne, Mass, *1000)
CAROM_QUANTITY_LITERAL(lb, Mass, *0.45359237)
CAROM_QUANTITY_LITERAL(slug, Mass, *(0.45359237 * 9.80665 / 0.3048))
CAROM_QUANTITY_LITERAL(gr, Mass, *0.45359237 / 7000)
CAROM_QUANTITY_LITERAL(m, Length, )
CAROM_QUANTITY_LITERAL(mm, Length, / 1000)
CAROM_QUANTITY_LITERAL(cm, Length, / 100)
CAROM_QUANTITY_LITERAL(km, Length, *1000)
CAROM_QUANTITY_LITERAL(in, Length, *0.0254)
CAROM_QUANTITY_LITERAL(ft, Length, *0.3048)
CAROM_QUANTITY_LITERAL(mi, Length, *1609.344)
CAROM_QUANTITY_LITERAL(nmi, Length, *1852)
CAROM_QUANTITY_LITERAL(s, Time, )
CAROM_QUANTITY_LITERAL(ms, Time, / 1000)
CAROM_QUANTITY_LITERAL(min, Time, *60)
CAROM_QUANTITY_LITERAL(h, Time, *3600)
CAROM_QUANTITY_LITERAL(K, Temperature, )
CAROM_QUANTITY_LITERAL(A, Current, )
CAROM_QUANTITY_LITERAL(m2, Area, )
CAROM_QUANTITY_LITERAL(m3, Volume, )
CAROM_QUANTITY_LITERAL(mps, Speed, )
CAROM_QUANTITY_LITERAL(kph, Speed, / 3.6)
CAROM_QUANTITY_LITERAL(mph, Speed, *0.44704)
CAROM_QUANTITY_LITERAL(kn, Speed, *1852 / 3600)
CAROM_QUANTITY_LITERAL(fps, Speed, *0.3048)
CAROM_QUANTITY_LITERAL(mps2, Acceleration, )
CAROM_QUANTITY_LITERAL(Hz, Frequency, )
CAROM_QUANTITY_LITERAL(N, Force, )
CAROM_QUANTITY_LITERAL(kN, Force, *1000)
CAROM_QUANTITY_LITERAL(lbf, Force, *4.4482216152605)
CAROM_QUANTITY_LITERAL(J, Energy, )
CAROM_QUANTITY_LITERAL(Nm, Energy, )
CAROM_QUANTITY_LITERAL(W, Power, )
CAROM_QUANTITY_LITERAL(kW, Power, *1000)
CAROM_QUANTITY_LITERAL(hp, Power, *745.69987158227022)
CAROM_QUANTITY_LITERAL(Pa, Pressure, )
CAROM_QUANTITY_LITERAL(kPa, Pressure, *1000)
CAROM_QUANTITY_LITERAL(psi, Pressure, *4.4482216152605 / 0.00064516)
CAROM_QUANTITY_LITERAL(atm, Pressure, *101325)
CAROM_QUANTITY_LITERAL(kg_per_m3, Density, )
CAROM_QUANTITY_LITERAL(kg_m2, MomentOfInertia, )
#undef CAROM_QUANTITY_LITERAL
/// Angles are plain numbers in radians.
consteval double operator""_rad(const char* text) { return detail::literal_value(text); }
consteval double operator""_deg(const char* text) { return detail::literal_value(text) * pi / 180; }

}  // namespace literals
}  // namespace carom::math
