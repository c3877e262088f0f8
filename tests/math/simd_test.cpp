// Lanes do what the scalar code does, bit for bit, at every width.
#include "carom/math/simd.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "carom/math/cpu.h"
#include "carom/math/vec.h"

namespace carom::test::simd_tests {
namespace {

template <class Width>
class Simd : public ::testing::Test {};
using Widths =
    ::testing::Types<std::integral_constant<int, 4>, std::integral_constant<int, 8>, std::integral_constant<int, 16>>;
TYPED_TEST_SUITE(Simd, Widths);

std::uint32_t bits_of_float(float x) { return std::bit_cast<std::uint32_t>(x); }

std::vector<float> awkward_floats() {
  std::vector<float> v = {0.0f, -0.0f, 1.0f, -1.0f, 1e-40f, -3e38f, INFINITY, -INFINITY, NAN, 0.1f, 7.25f, 1e-30f};
  std::uint32_t s = 12345;
  while (v.size() < 64) {
    s = s * 1664525u + 1013904223u;
    v.push_back(static_cast<float>(static_cast<std::int32_t>(s)) * 1e-7f);
  }
  return v;
}

TYPED_TEST(Simd, ArithmeticHasTheBitsOfTheScalarCode) {
  constexpr int W = TypeParam::value;
  using F = math::WideFloat<W>;
  const std::vector<float> v = awkward_floats();
  for (std::size_t i = 0; i + W <= v.size(); i += 3) {
    for (std::size_t j = 0; j + W <= v.size(); j += 5) {
      const F a = F::load(&v[i]), b = F::load(&v[j]);
      const F sum = a + b, difference = a - b, product = a * b, quotient = a / b, root = math::sqrt(math::abs(a));
      const F low = math::min(a, b), high = math::max(a, b), chosen = math::select(a < b, a, b),
              kept = math::keep(a >= b, a);
      for (int k = 0; k < W; ++k) {
        const float x = v[i + static_cast<std::size_t>(k)], y = v[j + static_cast<std::size_t>(k)];
        const auto same = [&](float got, float want) {
          if (std::isnan(want)) {
            EXPECT_TRUE(std::isnan(got));
          } else {
            EXPECT_EQ(bits_of_float(got), bits_of_float(want)) << x << " " << y;
          }
        };
        same(sum[k], x + y);
        same(difference[k], x - y);
        same(product[k], x * y);
        same(quotient[k], x / y);
        same(root[k], std::sqrt(std::fabs(x)));
        same(low[k], math::min(x, y));
        same(high[k], math::max(x, y));
        same(chosen[k], x < y ? x : y);
        same(kept[k], x >= y ? x : 0.0f);
        same(math::copysign(a, b)[k], std::copysign(x, y));
        same((-a)[k], -x);
      }
    }
  }
}

TYPED_TEST(Simd, MasksAndIntegers) {
  constexpr int W = TypeParam::value;
  using F = math::WideFloat<W>;
  using I = math::WideInt<W>;
  const I lanes = I::lanes();
  const auto odd = (lanes & I::splat(1)) == I::splat(1);
  EXPECT_EQ(math::bitmask(odd), 0xaaaaaaaau & ((1u << W) - 1u));
  EXPECT_TRUE(math::any(odd));
  EXPECT_FALSE(math::all(odd));
  EXPECT_TRUE(math::all(odd | !odd));
  EXPECT_TRUE(math::none(odd & !odd));
  EXPECT_TRUE(math::none(math::WideMask<W>::none()));
  EXPECT_TRUE(math::all(math::WideMask<W>::all()));
  for (int k = 0; k < W; ++k) {
    EXPECT_EQ(lanes[k], k);
    EXPECT_EQ(odd[k], k % 2 == 1);
    EXPECT_EQ((lanes * I::splat(-3) + I::splat(7))[k], 7 - 3 * k);
    EXPECT_EQ((I::splat(-256) >> 4)[k], -16);
    EXPECT_EQ((lanes << 3)[k], 8 * k);
    EXPECT_EQ(math::to_float(lanes)[k], static_cast<float>(k));
    EXPECT_EQ(math::to_int(math::to_float(lanes) * F::splat(-1.6f))[k],
              static_cast<int>(static_cast<float>(k) * -1.6f));
    EXPECT_EQ(math::select(odd, lanes, I::splat(-1))[k], k % 2 == 1 ? k : -1);
  }
  alignas(64) float aligned[W];
  F::splat(2.5f).store_aligned(aligned);
  EXPECT_EQ(F::load_aligned(aligned)[W - 1], 2.5f);
}

template <int W, int Columns>
void gathers_and_scatters() {
  std::vector<float> records(static_cast<std::size_t>(40 * Columns));
  for (std::size_t i = 0; i < records.size(); ++i) records[i] = static_cast<float>(i);
  std::vector<float> fallback(Columns);
  for (int c = 0; c < Columns; ++c) fallback[static_cast<std::size_t>(c)] = -1.0f - static_cast<float>(c);
  std::int32_t index[W];
  for (int i = 0; i < W; ++i) index[i] = i % 5 == 3 ? -1 : (7 * i + 3) % 40;
  math::WideFloat<W> columns[Columns];
  math::gather_rows<Columns, W>(records.data(), index, fallback.data(), columns);
  for (int i = 0; i < W; ++i) {
    for (int c = 0; c < Columns; ++c) {
      EXPECT_EQ(columns[c][i],
                index[i] < 0 ? -1.0f - static_cast<float>(c) : static_cast<float>(index[i] * Columns + c));
    }
  }
  std::vector<float> written = records;
  for (auto& column : columns) column = column + math::WideFloat<W>::splat(1000);
  math::scatter_rows<Columns>(written.data(), index, columns);
  std::vector<bool> touched(40);
  for (int i = 0; i < W; ++i) {
    if (index[i] >= 0) touched[static_cast<std::size_t>(index[i])] = true;
  }
  for (std::size_t i = 0; i < records.size(); ++i) {
    EXPECT_EQ(written[i], records[i] + (touched[i / Columns] ? 1000.0f : 0.0f));
  }
}

TYPED_TEST(Simd, RecordsAreTransposedIntoColumnsAndBack) {
  gathers_and_scatters<TypeParam::value, 4>();
  gathers_and_scatters<TypeParam::value, 8>();
  gathers_and_scatters<TypeParam::value, 12>();
  gathers_and_scatters<TypeParam::value, 16>();
}

TEST(Cpu, AChosenInstructionSetIsNeverAboveTheDetectedOne) {
  using math::InstructionSet;
  const InstructionSet best = math::detect_instruction_set();
  for (const InstructionSet wanted : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512}) {
    EXPECT_EQ(math::choose_instruction_set(wanted), std::min(wanted, best));
    EXPECT_EQ(math::instruction_set_of_width(math::simd_width(wanted)), wanted);
  }
}

}  // namespace
}  // namespace carom::test::simd_tests
