// Rotations: conventions, inverses of each other, exactness, limits.
#include "carom/math/rotation.h"

#include <gtest/gtest.h>

#include "carom/math/random.h"

namespace carom::test::rotation_tests {
namespace {

using namespace carom::math;

constexpr EulerOrder orders[] = {EulerOrder::xyz, EulerOrder::xzy, EulerOrder::yxz, EulerOrder::yzx,
                                 EulerOrder::zxy, EulerOrder::zyx, EulerOrder::xyx, EulerOrder::xzx,
                                 EulerOrder::yxy, EulerOrder::yzy, EulerOrder::zxz, EulerOrder::zyz};

double apart(const Quatd& a, const Quatd& b) { return min(length(a - b), length(a + b)); }
double apart(const Mat3d& a, const Mat3d& b) {
  double worst = 0;
  for (int i = 0; i < 3; ++i) worst = max(worst, length(a.column(i) - b.column(i)));
  return worst;
}

// The three elementary matrices, their quaternions and the Euler orders say the same thing.
TEST(Rotation, EulerOrdersAreProductsOfElementaryMatrices) {
  const auto elementary = [](char axis, double a) {
    return axis == 'x' ? rotation_x(a) : (axis == 'y' ? rotation_y(a) : rotation_z(a));
  };
  const char* names[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx", "xyx", "xzx", "yxy", "yzy", "zxz", "zyz"};
  Random random(1);
  for (int n = 0; n < 12; ++n) {
    for (int i = 0; i < 50; ++i) {
      const bool proper = n >= 6;
      const double first = random.uniform(-pi, pi);
      const double second = proper ? random.uniform(0.0, pi) : random.uniform(-pi / 2, pi / 2);
      const double third = random.uniform(-pi, pi);
      const Mat3d m = elementary(names[n][0], first) * elementary(names[n][1], second) * elementary(names[n][2], third);
      const Quatd q = from_euler_angles(EulerAngles<double>{first, second, third}, orders[n]);
      EXPECT_LT(apart(to_matrix(q), m), 1e-14) << names[n];
      const EulerAngles<double> e = euler_angles(q, orders[n]);
      EXPECT_NEAR(e.first, first, 1e-12) << names[n];
      EXPECT_NEAR(e.second, second, 1e-12) << names[n];
      EXPECT_NEAR(e.third, third, 1e-12) << names[n];
    }
  }
}

// In gimbal lock third is zero and the attitude is still the same one.
TEST(Rotation, GimbalLockKeepsTheAttitudeInEveryOrder) {
  for (int n = 0; n < 12; ++n) {
    const double locked[2] = {n < 6 ? -pi / 2 : 0.0, n < 6 ? pi / 2 : pi};
    for (const double second : locked) {
      for (double first = -3; first < 3; first += 0.37) {
        for (double third = -3; third < 3; third += 0.41) {
          const Quatd q = from_euler_angles(EulerAngles<double>{first, second, third}, orders[n]);
          const EulerAngles<double> e = euler_angles(q, orders[n]);
          EXPECT_LT(apart(from_euler_angles(e, orders[n]), q), 1e-14);
          EXPECT_NEAR(e.second, second, 1e-15 * 8);
        }
      }
    }
  }
  const YawPitchRoll<double> up = yaw_pitch_roll(from_yaw_pitch_roll(YawPitchRoll<double>{0.5, pi / 2, 0.2}));
  EXPECT_EQ(up.roll, 0);
  EXPECT_NEAR(up.yaw, 0.3, 1e-15);
}

TEST(Rotation, ExponentialAndLogarithmAreInverse) {
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    const double size = pi * exp2(-static_cast<double>(i % 60));
    const Vec3d v = random.on_sphere() * (size * 0.999);
    const Quatd q = from_rotation_vector(v);
    EXPECT_NEAR(length(q), 1, 4e-16);
    EXPECT_LT(length(rotation_vector(q) - v), 4e-15 * length(v));
    const AxisAngle<double> a = axis_angle(q);
    EXPECT_LT(apart(from_axis_angle(a.axis, a.angle), q), 1e-15);
    const Vec3f f = Vec3f(v);
    EXPECT_LT(length(rotation_vector(from_rotation_vector(f)) - f), 1e-6f * length(f));
  }
  EXPECT_EQ(rotation_vector(Quatd{}), (Vec3d{}));
  EXPECT_EQ(from_rotation_vector(Vec3d{}), Quatd{});
}

// A 2π spin returns −q, the same attitude: mechanics reference 11.
TEST(Rotation, FullTurnIsMinusOne) {
  const Quatd q = from_rotation_vector(Vec3d{0, 0, 2 * pi});
  EXPECT_NEAR(q.w, -1, 1e-15);
  EXPECT_LT(length(rotation_vector(q)), 1e-15 * 4);
}

// The exponential map is exact for a constant angular velocity, in any number of steps.
TEST(Rotation, ConstantAngularVelocityIsExact) {
  const Vec3d w{0.3, -1.2, 2.5};
  const Quatd start = from_axis_angle(Vec3d{1, 2, -1}, 0.7);
  Quatd q = start, body = start;
  for (int i = 0; i < 1000; ++i) {
    q = integrate_exact(q, w, 0.01);
    body = integrate_exact_body(body, w, 0.01);
  }
  EXPECT_LT(apart(q, integrate_exact(start, w, 10.0)), 1e-13);
  EXPECT_LT(apart(body, start * from_rotation_vector(w * 10.0)), 1e-13);
}

TEST(Rotation, MatrixToQuaternionInAllFourBranches) {
  Random random(3);
  for (int i = 0; i < 5000; ++i) {
    Quatd q = random.rotation();
    if (i % 4 == 1) q = normalize(Quatd{1e-9, q.vector()});
    if (i % 4 == 2) q = {0, normalize(Vec3d{1, 1e-8, -1e-9})};
    EXPECT_LT(apart(from_matrix(to_matrix(q)), q), 1e-15 * 4);
  }
}

TEST(Rotation, OrthonormalizeRepairsDrift) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Mat3d r = to_matrix(random.rotation());
    Mat3d m = r;
    for (int c = 0; c < 3; ++c) m.column(c) += random.in_sphere() * 1e-6;
    const Mat3d o = orthonormalize(m);
    EXPECT_NEAR(determinant(o), 1, 1e-15 * 4);
    EXPECT_LT(apart(transpose(o) * o, Mat3d::identity()), 1e-15 * 4);
    EXPECT_LT(apart(o, r), 1e-5);
  }
  EXPECT_NEAR(determinant(orthonormalize(Mat3d::zero())), 1, 1e-15);
}

TEST(Rotation, BetweenDirections) {
  Random random(5);
  for (int i = 0; i < 2000; ++i) {
    const Vec3d a = random.on_sphere();
    const Vec3d b =
        i % 3 == 0 ? normalize(-a + random.in_sphere() * exp2(-static_cast<double>(i % 50))) : random.on_sphere();
    const Quatd q = from_to(a, b);
    EXPECT_NEAR(length(q), 1, 4e-16);
    EXPECT_LT(length(rotate(q, a) - b), 1e-14);
  }
  for (const Vec3d a : {Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, 1}, Vec3d{0, 0, -1}}) {
    EXPECT_LT(length(rotate(from_to(a, -a), a) + a), 1e-15);
    EXPECT_EQ(from_to(a, a), Quatd{});
  }
}

TEST(Rotation, LookRotationHasForwardOnXAndUpNearY) {
  Random random(6);
  for (int i = 0; i < 1000; ++i) {
    const Vec3d f = random.on_sphere() * 3.0, up{0, 1, 0};
    const Quatd q = look_rotation(f, up);
    EXPECT_LT(length(rotate(q, Vec3d{1, 0, 0}) - normalize(f)), 1e-14);
    EXPECT_GE(dot(rotate(q, Vec3d{0, 1, 0}), up), 0);
    EXPECT_NEAR(dot(rotate(q, Vec3d{0, 0, 1}), up), 0, 1e-14);
  }
  EXPECT_LT(length(rotate(look_rotation(Vec3d{0, 2, 0}, Vec3d{0, 1, 0}), Vec3d{1, 0, 0}) - Vec3d{0, 1, 0}), 1e-15);
  EXPECT_EQ(look_rotation(Vec3d{}, Vec3d{0, 1, 0}), Quatd{});
}

TEST(Rotation, SlerpHasConstantSpeedAndTakesTheShorterWay) {
  Random random(7);
  for (int i = 0; i < 1000; ++i) {
    const Quatd a = random.rotation();
    const Quatd b =
        i % 5 == 0 ? normalize(a + random.rotation() * exp2(-static_cast<double>(i % 40))) : random.rotation();
    const double whole = angle_between(a, b);
    for (const double t : {0.0, 0.1, 0.5, 0.75, 1.0}) {
      EXPECT_NEAR(angle_between(a, slerp(a, b, t)), t * whole, 2e-15 * 4);
      EXPECT_LT(apart(slerp(a, -b, t), slerp(a, b, t)), 1e-15 * 4);
    }
    EXPECT_LT(apart(nlerp(a, b, 0.5), slerp(a, b, 0.5)), 1e-14);
    EXPECT_LT(apart(slerp(a, b, 0.3), a * from_rotation_vector(rotation_vector(conjugate(a) * b) * 0.3)), 1e-14);
  }
}

TEST(Rotation, SwingAndTwistMakeTheRotation) {
  Random random(8);
  for (int i = 0; i < 1000; ++i) {
    const Quatd q = random.rotation();
    const Vec3d axis = random.on_sphere();
    const SwingTwist<double> st = swing_twist(q, axis);
    EXPECT_LT(apart(st.swing * st.twist, q), 1e-14);
    EXPECT_NEAR(dot(st.swing.vector(), axis), 0, 1e-14);
    EXPECT_LT(length(cross(st.twist.vector(), axis)), 1e-14);
    const double angle = twist_angle(q, axis);
    EXPECT_LT(apart(from_axis_angle(axis, angle), st.twist), 1e-14);
  }
  const SwingTwist<double> half = swing_twist(Quatd{0, 1, 0, 0}, Vec3d{0, 0, 1});
  EXPECT_EQ(half.twist, Quatd{});
}

TEST(Rotation, PlaneRotations) {
  for (double a = -3.1; a < 3.1; a += 0.1) {
    EXPECT_NEAR(angle_of(from_angle(a)), a, 4e-16 * 2);
    EXPECT_NEAR(angle_of(slerp(from_angle(0.2), from_angle(0.2 + a), 0.5)), 0.2 + a / 2, 1e-15);
    EXPECT_NEAR(wrap_angle(a + 20 * pi), a, 1e-14);
  }
  EXPECT_EQ(wrap_angle(pi), pi);
  EXPECT_LE(abs(wrap_angle(1e9f)), pi_f);
}

}  // namespace
}  // namespace carom::test::rotation_tests
