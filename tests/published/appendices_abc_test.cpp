// Chapter 11.1–11.4 and appendices A–C of the subject: vectors, matrices, quaternions.
#include <gtest/gtest.h>

#include "carom/math/random.h"
#include "carom/math/rotation.h"

namespace carom::test::appendices {
namespace {

using namespace carom::math;

double attitude_error(const Quatd& a, const Quatd& b) { return min(length(a - b), length(a + b)); }

// Appendix A: (1, 2, 3) × (4, 5, 6) = (−3, 6, −3), and its dot with (7, 8, 10) is −3. Exact.
TEST(AppendixA, CrossAndTripleProduct) {
  const Vec3d a{1, 2, 3}, b{4, 5, 6}, c{7, 8, 10};
  EXPECT_EQ(cross(a, b), (Vec3d{-3, 6, -3}));
  EXPECT_EQ(dot(cross(a, b), c), -3);
  EXPECT_EQ(triple(c, a, b), -3);
}

// Appendix A: the rest of the algebra, on exact numbers.
TEST(AppendixA, VectorAlgebra) {
  Vec3d v{3, 4, 12};
  EXPECT_EQ(length(v), 13);
  EXPECT_EQ(-v, (Vec3d{-3, -4, -12}));
  v += Vec3d{1, 1, 1};
  v -= Vec3d{2, 2, 2};
  v *= 4;
  v /= 2;
  EXPECT_EQ(v, (Vec3d{4, 6, 22}));
  EXPECT_EQ(v + v, v * 2.0);
  EXPECT_EQ(2.0 * v / 2.0, v);
  EXPECT_EQ(normalize(Vec3d{}), (Vec3d{}));
  EXPECT_EQ(normalize(Vec3d{0, -5, 0}), (Vec3d{0, -1, 0}));
}

// 1.3 and appendix A: x̂ × ŷ = ẑ. Exact.
TEST(AppendixA, AxesAreRightHanded) { EXPECT_EQ(cross(Vec3d{1, 0, 0}, Vec3d{0, 1, 0}), (Vec3d{0, 0, 1})); }

// Appendix B: M · M⁻¹ = E to 1e-15 × condition number (Frobenius).
TEST(AppendixB, InverseTimesMatrixIsTheUnitMatrix) {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    Mat3d m;
    for (int c = 0; c < 3; ++c) m.column(c) = random.in_sphere();
    const Mat3d inv = inverse(m), e = m * inv;
    double norm = 0, inverse_norm = 0, off = 0;
    for (int c = 0; c < 3; ++c) {
      norm += length_squared(m.column(c));
      inverse_norm += length_squared(inv.column(c));
      off = max(off, length(e.column(c) - Mat3d::identity().column(c)));
    }
    EXPECT_LE(off, 1e-15 * sqrt(norm) * sqrt(inverse_norm));
  }
}

// Appendix B: determinant, transpose, products on both sides, on exact numbers.
TEST(AppendixB, MatrixAlgebra) {
  const Mat3d m{{2, 0, 1}, {3, 1, 0}, {1, 4, 5}};  // columns
  EXPECT_EQ(determinant(m), 21);
  EXPECT_EQ(transpose(transpose(m)), m);
  const Vec3d v{1, 2, 3};
  EXPECT_EQ(m * v, (Vec3d{11, 14, 16}));
  EXPECT_EQ(v * m, (Vec3d{5, 5, 24}));
  EXPECT_EQ(m + m, 2.0 * m);
  EXPECT_EQ((m - m), Mat3d::zero());
  EXPECT_EQ((4.0 * m) / 2.0, m * 2.0);
  EXPECT_EQ(m * Mat3d::identity(), m);
}

// Chapter 11.2: 120° about (1, 1, 1) is q = (½, ½, ½, ½) and takes x̂ to ŷ. Tolerance: rounding.
TEST(Chapter11, ThirdOfATurnAboutTheDiagonal) {
  const Quatd q = from_axis_angle(Vec3d{1, 1, 1}, 2 * pi / 3);
  EXPECT_LT(length(q - Quatd{0.5, 0.5, 0.5, 0.5}), 4e-16);
  EXPECT_LT(length(rotate(q, Vec3d{1, 0, 0}) - Vec3d{0, 1, 0}), 1e-15);
  const AxisAngle<double> a = axis_angle(q);
  EXPECT_NEAR(a.angle, 2 * pi / 3, 1e-15);
  EXPECT_LT(length(a.axis - Vec3d{1, 1, 1} / sqrt(3.0)), 1e-15);
}

// Chapter 11.3: roll, pitch, yaw of 30, 40, 50° in z-y-x order: q = (.860042, .080805, .402198, .303372), last digit.
TEST(Chapter11, RollPitchYawToQuaternion) {
  const Quatd q = from_yaw_pitch_roll(YawPitchRoll<double>{radians(50.0), radians(40.0), radians(30.0)});
  EXPECT_NEAR(q.w, 0.860042, 5e-7);
  EXPECT_NEAR(q.x, 0.080805, 5e-7);
  EXPECT_NEAR(q.y, 0.402198, 5e-7);
  EXPECT_NEAR(q.z, 0.303372, 5e-7);
}

// Chapter 11.4: ||q| − 1| < 1e-12 and det R = 1 ± 1e-12 after 1e6 steps of either integration.
TEST(Chapter11, LengthStaysOneOverAMillionSteps) {
  Quatd exact, explicit_step;
  const Vec3d w{0.7, -1.1, 2.3};
  for (int i = 0; i < 1000000; ++i) {
    explicit_step = integrate(explicit_step, w * 1e-3);
    if (i % 4 == 0) exact = integrate_exact(exact, w, 4e-3);
  }
  EXPECT_LT(abs(length(exact) - 1), 1e-12);
  EXPECT_LT(abs(length(explicit_step) - 1), 1e-12);
  EXPECT_NEAR(determinant(to_matrix(exact)), 1, 1e-12);
  EXPECT_NEAR(determinant(to_matrix(explicit_step)), 1, 1e-12);
  // The exponential map also keeps the angle: 1000 s of constant ω is one rotation vector.
  EXPECT_LT(attitude_error(exact, from_rotation_vector(w * 1000.0)), 1e-9);
}

// Chapter 11.4: a 2π spin returns −q, the same attitude. Tolerance 1e-12 over 1000 steps.
TEST(Chapter11, FullSpinReturnsMinusQ) {
  const Quatd start = from_axis_angle(Vec3d{1, -2, 0.5}, 1.1);
  Quatd q = start;
  for (int i = 0; i < 1000; ++i) q = integrate_exact(q, Vec3d{0, 2 * pi, 0}, 1e-3);
  EXPECT_LT(length(q + start), 1e-12);
  const Vec3d v{0.3, 0.2, -0.7};
  EXPECT_LT(length(rotate(q, v) - rotate(start, v)), 1e-12);
}

// Appendix C: q ↔ R ↔ Euler round trips below 1e-12 over 1e6 random attitudes; every fourth within 1e-12 … 1 rad of
// pitch ±90°, every sixteenth exactly there.
TEST(AppendixC, RoundTripsOverAMillionAttitudes) {
  Random random(2);
  double worst_matrix = 0, worst_euler = 0;
  for (int i = 0; i < 1000000; ++i) {
    Quatd q;
    if (i % 4 == 0) {
      const double sign = (i & 4) != 0 ? 1.0 : -1.0;
      const double off = i % 16 == 0 ? 0.0 : 1.0 / static_cast<double>(std::uint64_t{1} << (random.bits32() % 40));
      const double yaw = random.uniform(-pi, pi);
      q = from_yaw_pitch_roll(YawPitchRoll<double>{yaw, sign * (pi / 2 - off), random.uniform(-pi, pi)});
    } else {
      q = random.rotation();
    }
    const Quatd r = from_matrix(to_matrix(q));
    worst_matrix = max(worst_matrix, attitude_error(r, q));
    worst_euler = max(worst_euler, attitude_error(from_yaw_pitch_roll(yaw_pitch_roll(r)), q));
  }
  EXPECT_LT(worst_matrix, 1e-12);
  EXPECT_LT(worst_euler, 1e-12);
}

// Appendix C: products with vectors, conjugate, inverse, magnitude, on exact numbers.
TEST(AppendixC, QuaternionAlgebra) {
  const Quatd i{0, 1, 0, 0}, j{0, 0, 1, 0}, k{0, 0, 0, 1};
  EXPECT_EQ(i * j, k);
  EXPECT_EQ(j * k, i);
  EXPECT_EQ(k * i, j);
  EXPECT_EQ(i * i, (Quatd{-1, 0, 0, 0}));
  const Quatd q{1, -2, 4, 2};
  EXPECT_EQ(length(q), 5);
  EXPECT_EQ(q * conjugate(q), (Quatd{25, 0, 0, 0}));
  EXPECT_LT(length(q * inverse(q) - Quatd{}), 1e-16 * 4);
  EXPECT_EQ(q * Vec3d(1, 0, 0), (q * i));
  EXPECT_EQ(Vec3d(0, 1, 0) * q, (j * q));
  EXPECT_EQ(q.vector(), (Vec3d{-2, 4, 2}));
  EXPECT_EQ(2.0 * q / 2.0, q);
  EXPECT_EQ(q - q, (Quatd{0, 0, 0, 0}));
}

}  // namespace
}  // namespace carom::test::appendices
