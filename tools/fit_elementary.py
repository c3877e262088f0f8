#!/usr/bin/env python3
"""Derive the constants of carom/math/elementary.cpp and print carom/math/detail/elementary_tables.h.

Needs mpmath. Polynomials are Chebyshev fits in 60 digits of the remainder after the leading terms, so they are within a
small factor of the minimax; the theoretical error of each is printed to standard error, relative to the function.
Run: tools/fit_elementary.py > carom/math/detail/elementary_tables.h
"""
import struct
import sys

from mpmath import mp, mpf

mp.dps = 60


def fit(name, remainder, end, terms, weight):
    """Coefficients, lowest first, of `remainder` on [end[0], end[1]]; weight(z, e): relative error of the whole."""
    coefficients = [float(c) for c in reversed(mp.chebyfit(remainder, end, terms))]
    worst = mpf(0)
    for i in range(1, 400):
        z = end[0] + (end[1] - end[0]) * mpf(i) / 400
        value = mp.polyval([mpf(c) for c in reversed(coefficients)], z)
        worst = max(worst, abs(weight(z, value - remainder(z))))
    print(f"{name}: {terms} terms, relative error 2^{float(mp.log(worst, 2)):.1f}", file=sys.stderr)
    body = ", ".join(c.hex() for c in coefficients)
    print(f"inline constexpr double {name}[] = {{{body}}};")


def top_bits(x, bits):
    """x cut to `bits` significant bits, as a float."""
    exponent = int(mp.floor(mp.log(abs(x), 2))) + 1
    scale = mpf(2) ** (bits - exponent)
    return float(mp.floor(x * scale) / scale)


def chain(name, x, bits):
    """x as a sum of short doubles of the given sizes and one full double."""
    parts = []
    for b in bits:
        parts.append(top_bits(x, b))
        x -= mpf(parts[-1])
    parts.append(float(x))
    print(f"inline constexpr double {name}[] = {{{', '.join(p.hex() for p in parts)}}};")


def pairs(name, values):
    rows = []
    for v in values:
        hi = float(v)
        rows.append(f"{{{hi.hex()}, {float(v - mpf(hi)).hex()}}}")
    print(f"inline constexpr double {name}[][2] = {{{', '.join(rows)}}};")


def as_double(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def series(f, g, small):
    """g, or the limit polynomial f where g would cancel."""
    return lambda z: f(z) if abs(z) < small else g(z)


print("// Constants of the elementary functions, printed by tools/fit_elementary.py. Do not edit.")
print("#pragma once\n\n#include <cstdint>\n\nnamespace carom::math::detail {\n")

root = mp.sqrt
quarter = (mp.pi / 4 * mpf("1.0001")) ** 2
tiny = mpf(10) ** -12
print("// sin r = r + r³ S(r²), cos r = 1 − r²/2 + r⁴ C(r²), |r| ≤ π/4.")
fit("sin_terms", series(lambda z: -mpf(1) / 6 + z / 120 - z * z / 5040, lambda z: (mp.sin(root(z)) - root(z)) / root(z) ** 3, tiny),
    [mpf(0), quarter], 6, lambda z, e: e * z)
fit("cos_terms", series(lambda z: mpf(1) / 24 - z / 720 + z * z / 40320, lambda z: (mp.cos(root(z)) - 1 + z / 2) / z**2, tiny),
    [mpf(0), quarter], 6, lambda z, e: e * z * z / mp.cos(root(z)))
print("// π/2 in three parts of 33 bits and a rest; 2/π.")
chain("half_pi_parts", mp.pi / 2, [33, 33, 33])
pairs("half_pi", [mp.pi / 2])
pairs("pi_pair", [mp.pi])
print(f"inline constexpr double two_over_pi = {float(2 / mp.pi).hex()};")
mp.prec = 1600
whole = int(mp.floor(2 / mp.pi * mpf(2) ** 1344))
mp.dps = 60
words = [(whole >> (1344 - 64 * (i + 1))) & (2**64 - 1) for i in range(21)]
print("// The first 1344 bits of 2/π behind the binary point, highest word first.")
print(f"inline constexpr std::uint64_t two_over_pi_words[] = {{{', '.join(f'0x{w:016x}' for w in words)}}};")

print("// atan(k/16); atan t = t + t³ A(t²), |t| ≤ 1/31.")
pairs("atan_table", [mp.atan(mpf(k) / 16) for k in range(17)])
fit("atan_terms", series(lambda z: -mpf(1) / 3 + z / 5 - z * z / 7, lambda z: (mp.atan(root(z)) - root(z)) / root(z) ** 3, tiny),
    [mpf(0), (mpf(1) / 31) ** 2], 5, lambda z, e: e * z)

print("// 2^(j/32); eʳ = 1 + r + r² E(r), |r| ≤ ln 2/63.")
pairs("exp2_table", [mpf(2) ** (mpf(j) / 32) for j in range(32)])
fit("exp_terms", series(lambda r: mpf(1) / 2 + r / 6 + r * r / 24, lambda r: (mp.exp(r) - 1 - r) / r**2, tiny),
    [-mp.log(2) / 63, mp.log(2) / 63], 6, lambda r, e: e * r * r)
chain("ln2_over_32", mp.log(2) / 32, [37])
print(f"inline constexpr double thirty_two_over_ln2 = {float(32 / mp.log(2)).hex()};")
pairs("ln2", [mp.log(2)])

print("// ln(1 + r) = r − r²/2 + r³ L(r), |r| < 2⁻⁷.")
fit("log_terms", series(lambda r: mpf(1) / 3 - r / 4 + r * r / 5, lambda r: (mp.log1p(r) - r + r * r / 2) / r**3, tiny),
    [-mpf(2) ** -7, mpf(2) ** -7], 8, lambda r, e: e * r * r)
grid = mpf(2) ** 42
high = mp.nint(mp.log(2) * grid) / grid
print("// ln 2 in multiples of 2⁻⁴², and the rest.")
print(f"inline constexpr double ln2_grid[] = {{{float(high).hex()}, {float(mp.log(2) - high).hex()}}};")
offset = 0x3FE6800000000000
rows = []
for i in range(128):
    middle = as_double(offset + (i << 45) + (1 << 44))
    c = 1.0 if i in (75, 76) else round(512 / middle) / 512
    value = -mp.log(mpf(c))
    hi = mp.nint(value * grid) / grid
    rows.append(f"{{{c.hex()}, {float(hi).hex()}, {float(value - hi).hex()}}}")
print("// For each of 128 cells of the mantissa from 0.703125 on: c ≈ 1/m in ten bits, −ln c in multiples of 2⁻⁴², the rest.")
print(f"inline constexpr std::uint64_t log_offset = 0x{offset:016x};")
print(f"inline constexpr double log_table[][3] = {{{', '.join(rows)}}};")
pairs("one_over_ln2", [1 / mp.log(2)])
pairs("one_over_ln10", [1 / mp.log(10)])

limit = mpf("0.3")
print("// sinh x = x + x³ H(x²) and tanh x = x + x³ T(x²), |x| ≤ 0.3; eˣ − 1 = x + x²/2 + x³ M(x), |x| ≤ 0.3.")
fit("sinh_terms", series(lambda z: mpf(1) / 6 + z / 120, lambda z: (mp.sinh(root(z)) - root(z)) / root(z) ** 3, tiny),
    [mpf(0), limit**2], 5, lambda z, e: e * z)
fit("tanh_terms", series(lambda z: -mpf(1) / 3 + 2 * z / 15, lambda z: (mp.tanh(root(z)) - root(z)) / root(z) ** 3, tiny),
    [mpf(0), limit**2], 9, lambda z, e: e * z)
fit("expm1_terms", series(lambda x: mpf(1) / 6 + x / 24, lambda x: (mp.expm1(x) - x - x * x / 2) / x**3, tiny),
    [-limit, limit], 9, lambda x, e: e * x * x)
print("// A first guess of the cube root on [1, 8), good to a part in a hundred.")
fit("cbrt_terms", lambda x: mp.cbrt(x), [mpf(1), mpf(8)], 4, lambda x, e: e / mp.cbrt(x))
print("\n}  // namespace carom::math::detail")
