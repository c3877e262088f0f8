// The small dense algebra of joint trees: factors of blocks, rows, velocities and inertia in double.
#pragma once

#include "carom/rigid/detail/joint_tree.h"
#include "carom/rigid/detail/load.h"

namespace carom::rigid::detail {

inline constexpr double locked_mass = 1e8;  ///< times the body's own: what a locked axis weighs

/// m = L D Lᵀ in place, L below the diagonal; returns 1/D.
template <int N>
void factorise_block(double (&m)[N][N], double (&inverse)[N], int n) {
  double d[N];
  for (int j = 0; j < n; ++j) {
    double pivot = m[j][j];
    for (int k = 0; k < j; ++k) pivot -= m[j][k] * m[j][k] * d[k];
    d[j] = pivot;
    inverse[j] = pivot > 0 ? 1 / pivot : 0;
    for (int i = j + 1; i < n; ++i) {
      double x = m[i][j];
      for (int k = 0; k < j; ++k) x -= m[i][k] * m[j][k] * d[k];
      m[i][j] = x * inverse[j];
    }
  }
}
template <int N>
void solve_block(const double (&m)[N][N], const double (&inverse)[N], int n, double* x) {
  for (int i = 1; i < n; ++i)
    for (int k = 0; k < i; ++k) x[i] -= m[i][k] * x[k];
  for (int i = 0; i < n; ++i) x[i] *= inverse[i];
  for (int i = n - 2; i >= 0; --i)
    for (int k = i + 1; k < n; ++k) x[i] -= m[k][i] * x[k];
}
template <int N>
double inner_product(const double (&a)[N], const double (&b)[N]) {
  double sum = a[0] * b[0];
  for (int i = 1; i < N; ++i) sum += a[i] * b[i];
  return sum;
}

inline void fill_row(double (&row)[3], double sign, Vec2f n, float lever) {
  row[0] = sign * double(n.x);
  row[1] = sign * double(n.y);
  row[2] = sign * double(lever);
}
inline void fill_row(double (&row)[6], double sign, Vec3f n, Vec3f lever) {
  for (int i = 0; i < 3; ++i) {
    row[i] = sign * double(n[i]);
    row[3 + i] = sign * double(lever[i]);
  }
}
inline void velocity_of(double (&v)[3], const SolverBody<Dim2>& s) {
  v[0] = double(s.linear_velocity.x);
  v[1] = double(s.linear_velocity.y);
  v[2] = double(s.angular_velocity);
}
inline void velocity_of(double (&v)[6], const SolverBody<Dim3>& s) {
  for (int i = 0; i < 3; ++i) {
    v[i] = double(s.linear_velocity[i]);
    v[3 + i] = double(s.angular_velocity[i]);
  }
}
inline void add_velocity(SolverBody<Dim2>& s, const double (&change)[3]) {
  s.linear_velocity = {float(double(s.linear_velocity.x) + change[0]), float(double(s.linear_velocity.y) + change[1])};
  s.angular_velocity = float(double(s.angular_velocity) + change[2]);
}
inline void add_velocity(SolverBody<Dim3>& s, const double (&change)[6]) {
  for (int i = 0; i < 3; ++i) {
    s.linear_velocity[i] = float(double(s.linear_velocity[i]) + change[i]);
    s.angular_velocity[i] = float(double(s.angular_velocity[i]) + change[3 + i]);
  }
}

/// How many times its own mass a body has for what presses it together (load.h).
template <class D>
double mass_factor(const BodyMotion<D>& m) {
  return 1 / double(load_share(m));
}

inline void fill_inertia(TreeBody<Dim2>& out, const BodyMotion<Dim2>& m, const Rot2f&, std::uint8_t locks) {
  const bool turns = m.inertia > 0 && (locks & 32) == 0;
  const double inertia = mass_factor(m) * double(m.inertia);
  out.inertia[0][0] = inertia;
  out.mass[2][2] = turns ? inertia : locked_mass * double(max(m.inertia, m.mass));
  out.inverse_inertia[0][0] = turns ? 1 / inertia : 0;
}
inline void fill_inertia(TreeBody<Dim3>& out, const BodyMotion<Dim3>& m, const Quatf& rotation, std::uint8_t locks) {
  const Vec3f size{m.inertia.cx.x, m.inertia.cy.y, m.inertia.cz.z};
  const double mean = (double(size.x) + double(size.y) + double(size.z)) / 3;
  const double heavy = locked_mass * (mean > 0 ? mean : double(m.mass));
  Mat3d inertia = Mat3d::diagonal({mean, mean, mean});
  if (m.gyroscopic) {
    const Mat3d r = Mat3d(to_matrix(rotation));
    inertia = r * Mat3d(m.inertia) * transpose(r);
  }
  const double half = 0.5 * mass_factor(m);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      out.inertia[i][k] = out.mass[3 + i][3 + k] = half * (inertia.column(k)[i] + inertia.column(i)[k]);
  for (int i = 0; i < 3; ++i)
    if (!(mean > 0) || (locks >> (3 + i) & 1) != 0) out.mass[3 + i][3 + i] += heavy;
  double factor[3][3], inverse[3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) factor[i][k] = out.mass[3 + i][3 + k];
  factorise_block(factor, inverse, 3);
  for (int i = 0; i < 3; ++i) {
    double column[3] = {};
    column[i] = 1;
    solve_block(factor, inverse, 3, column);
    for (int k = 0; k < 3; ++k) out.inverse_inertia[k][i] = column[k];
  }
}

}  // namespace carom::rigid::detail
