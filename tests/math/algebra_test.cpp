// Vector, matrix and quaternion algebra against the textbook sums in quadruple precision.
#include <gtest/gtest.h>

#include "carom/math/eigen.h"
#include "carom/math/random.h"
#include "carom/math/rotation.h"

namespace carom::test::algebra_tests {
namespace {

using namespace carom::math;
#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 Quad;
#else
typedef long double Quad;
#endif
constexpr double unit = 0x1p-53;
constexpr int rounds = 20000;

double absolute(Quad x) { return static_cast<double>(x < 0 ? -x : x); }

struct Draw {
  Random random{20250101};
  double number() {
    const double mantissa = random.uniform(-1.0, 1.0);
    return mantissa * exp2(random.uniform(-20.0, 20.0));
  }
  Vec3d vector() {
    const double x = number();
    const double y = number();
    return {x, y, number()};
  }
  Mat3d matrix() {
    const Vec3d x = vector();
    const Vec3d y = vector();
    return {x, y, vector()};
  }
};

// |error| ≤ n · u · Σ|terms|: the standard bound of a sum of products (Higham 2002, eq. 3.5).
void expect_sum(double got, std::initializer_list<std::pair<double, double>> factors) {
  Quad exact = 0;
  double size = 0;
  for (const auto& [a, b] : factors) {
    exact += Quad(a) * Quad(b);
    size += abs(a * b);
  }
  EXPECT_LE(absolute(Quad(got) - exact), static_cast<double>(factors.size() + 1) * unit * size);
}

TEST(AlgebraFuzz, VectorProducts) {
  Draw draw;
  for (int i = 0; i < rounds; ++i) {
    const Vec3d a = draw.vector(), b = draw.vector();
    expect_sum(dot(a, b), {{a.x, b.x}, {a.y, b.y}, {a.z, b.z}});
    const Vec3d c = cross(a, b);
    for (int k = 0; k < 3; ++k) {
      const int l = (k + 1) % 3, m = (k + 2) % 3;
      expect_sum(c[k], {{a[l], b[m]}, {-a[m], b[l]}});
    }
    expect_sum(cross(Vec2d{a.x, a.y}, Vec2d{b.x, b.y}), {{a.x, b.y}, {-a.y, b.x}});
    const double l = length(a);
    EXPECT_LE(absolute(Quad(l) * Quad(l) - (Quad(a.x) * a.x + Quad(a.y) * a.y + Quad(a.z) * a.z)), 8 * unit * l * l);
  }
}

TEST(AlgebraFuzz, MatrixProducts) {
  Draw draw;
  for (int i = 0; i < rounds / 4; ++i) {
    const Mat3d a = draw.matrix(), b = draw.matrix(), p = a * b;
    const Vec3d v = draw.vector(), av = a * v, va = v * a;
    for (int r = 0; r < 3; ++r) {
      expect_sum(av[r], {{a(r, 0), v.x}, {a(r, 1), v.y}, {a(r, 2), v.z}});
      expect_sum(va[r], {{a(0, r), v.x}, {a(1, r), v.y}, {a(2, r), v.z}});
      for (int c = 0; c < 3; ++c) expect_sum(p(r, c), {{a(r, 0), b(0, c)}, {a(r, 1), b(1, c)}, {a(r, 2), b(2, c)}});
    }
    const Mat2d s{{a.cx.x, a.cx.y}, {a.cy.x, a.cy.y}};
    expect_sum(determinant(s), {{s(0, 0), s(1, 1)}, {-s(0, 1), s(1, 0)}});
  }
}

// M·M⁻¹ = E to 1e-15 × condition number: mechanics reference, appendix B.
TEST(AlgebraFuzz, InversesOfOrderTwoThreeAndFour) {
  Random random(11);
  const auto entry = [&] { return random.uniform(-1.0, 1.0); };
  for (int i = 0; i < rounds / 4; ++i) {
    Mat4d m;
    for (Vec4d* c : {&m.cx, &m.cy, &m.cz, &m.cw}) {
      for (int k = 0; k < 4; ++k) (*c)[k] = entry();
    }
    const Mat3d m3{{m.cx.x, m.cx.y, m.cx.z}, {m.cy.x, m.cy.y, m.cy.z}, {m.cz.x, m.cz.y, m.cz.z}};
    const Mat2d m2{{m.cx.x, m.cx.y}, {m.cy.x, m.cy.y}};
    const auto check = [&](const auto& a, int n) {
      const auto inv = inverse(a);
      double norm = 0, inverse_norm = 0;
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          norm += a(r, c) * a(r, c);
          inverse_norm += inv(r, c) * inv(r, c);
        }
      }
      const double condition = sqrt(norm) * sqrt(inverse_norm);
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          Quad sum = r == c ? -1 : 0;
          for (int k = 0; k < n; ++k) sum += Quad(a(r, k)) * Quad(inv(k, c));
          EXPECT_LE(absolute(sum), 1e-15 * condition);
        }
      }
    };
    check(m2, 2);
    check(m3, 3);
    check(m, 4);
    EXPECT_NEAR(determinant(transpose(m)), determinant(m), 1e-14);
    EXPECT_NEAR(determinant(affine(m3, Vec3d{1, 2, 3})), determinant(m3), 1e-15);
  }
  EXPECT_EQ(inverse(Mat3d::zero()), Mat3d::zero());
}

TEST(AlgebraFuzz, QuaternionProductIsHamiltons) {
  Draw draw;
  for (int i = 0; i < rounds; ++i) {
    const Quatd a{draw.number(), draw.vector()}, b{draw.number(), draw.vector()};
    const Quatd p = a * b;
    expect_sum(p.w, {{a.w, b.w}, {-a.x, b.x}, {-a.y, b.y}, {-a.z, b.z}});
    expect_sum(p.x, {{a.w, b.x}, {a.x, b.w}, {a.y, b.z}, {-a.z, b.y}});
    expect_sum(p.y, {{a.w, b.y}, {a.y, b.w}, {a.z, b.x}, {-a.x, b.z}});
    expect_sum(p.z, {{a.w, b.z}, {a.z, b.w}, {a.x, b.y}, {-a.y, b.x}});
  }
}

TEST(AlgebraFuzz, RotationByQuaternionAndByMatrix) {
  Draw draw;
  for (int i = 0; i < rounds; ++i) {
    const Quatd q = draw.random.rotation();
    const Vec3d v = draw.vector();
    // q v q* in quadruple precision, with |q|² divided out.
    const Quad w = q.w, x = q.x, y = q.y, z = q.z, n = w * w + x * x + y * y + z * z;
    const Quad m[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                          {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                          {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    const Vec3d by_quaternion = rotate(q, v), by_matrix = to_matrix(q) * v;
    for (int r = 0; r < 3; ++r) {
      const Quad exact = (m[r][0] * v.x + m[r][1] * v.y + m[r][2] * v.z) / n;
      EXPECT_LE(absolute(by_quaternion[r] - exact), 16 * unit * length(v));
      EXPECT_LE(absolute(by_matrix[r] - exact), 16 * unit * length(v));
    }
    EXPECT_LE(length(inverse_rotate(q, by_quaternion) - v), 16 * unit * length(v));
  }
}

// A = V Λ Vᵀ, VᵀV = E, det V = 1, ascending: also for equal, zero and widely spread eigenvalues.
TEST(Eigen, SymmetricThreeByThree) {
  Random random(12);
  for (int i = 0; i < 5000; ++i) {
    Vec3d values = random.on_sphere();
    if (i % 5 == 1) values.y = values.x;
    if (i % 5 == 2) values = {values.x, values.x, values.x};
    if (i % 5 == 3) values = {1e-12, values.y, 1e6};
    if (i % 5 == 4) values.z = 0;
    const Mat3d r = to_matrix(random.rotation());
    Mat3d a = r * Mat3d::diagonal(values) * transpose(r);
    a = (a + transpose(a)) * 0.5;
    const Eigen3 e = symmetric_eigen(a);
    const double size = max(abs(values.x), max(abs(values.y), abs(values.z)));
    EXPECT_LE(e.values.x, e.values.y);
    EXPECT_LE(e.values.y, e.values.z);
    EXPECT_NEAR(determinant(e.vectors), 1, 1e-14);
    const Mat3d back = e.vectors * Mat3d::diagonal(e.values) * transpose(e.vectors);
    for (int c = 0; c < 3; ++c) {
      EXPECT_LT(length(back.column(c) - a.column(c)), 1e-14 * size);
      EXPECT_NEAR(length(e.vectors.column(c)), 1, 1e-14);
    }
    EXPECT_NEAR(e.values.x + e.values.y + e.values.z, trace(a), 1e-14 * size);
    const Eigen2 plane = symmetric_eigen(Mat2d{{a.cx.x, a.cx.y}, {a.cy.x, a.cy.y}});
    for (int c = 0; c < 2; ++c) {
      const Vec2d v = c == 0 ? plane.vectors.cx : plane.vectors.cy;
      const Vec2d image{a(0, 0) * v.x + a(0, 1) * v.y, a(1, 0) * v.x + a(1, 1) * v.y};
      EXPECT_LT(length(image - v * plane.values[c]), 1e-14 * size);
    }
    EXPECT_LE(plane.values.x, plane.values.y);
    EXPECT_NEAR(determinant(plane.vectors), 1, 1e-14);
  }
}

TEST(Eigen, DiagonalMatricesKeepTheCoordinateAxes) {
  const Eigen3 e = symmetric_eigen(Mat3d::diagonal({3, 1, 2}));
  EXPECT_EQ(e.values, (Vec3d{1, 2, 3}));
  EXPECT_EQ(e.vectors.cx, (Vec3d{0, 1, 0}));
  EXPECT_EQ(e.vectors.cy, (Vec3d{0, 0, 1}));
  EXPECT_EQ(e.vectors.cz, (Vec3d{1, 0, 0}));
  EXPECT_EQ(symmetric_eigen(Mat3d::zero()).vectors, Mat3d::identity());
}

}  // namespace
}  // namespace carom::test::algebra_tests
