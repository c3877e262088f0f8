// One lane of arrays of lanes: a body's or a joint's numbers into its column.
#pragma once

#include <cstddef>

#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

template <std::size_t N, int W, class V>
void set_lane(float (&lanes)[N][W], int lane, const V& v) {
  for (std::size_t i = 0; i < N; ++i) lanes[i][lane] = v[int(i)];
}
template <int W>
void set_lane(float (&lanes)[2][W], int lane, const Rot2f& q) {
  lanes[0][lane] = q.c;
  lanes[1][lane] = q.s;
}
template <int W>
void set_lane(float (&lanes)[4][W], int lane, const Quatf& q) {
  lanes[0][lane] = q.w;
  for (int i = 0; i < 3; ++i) lanes[i + 1][lane] = q.vector()[i];
}
template <int W>
void set_lane(float (&lanes)[6][W], int lane, const Mat3f& m) {
  const float t[6] = {m.cx.x, m.cx.y, m.cx.z, m.cy.y, m.cy.z, m.cz.z};
  for (int i = 0; i < 6; ++i) lanes[i][lane] = t[i];
}
template <int W>
void set_lane(float (&lanes)[W], int lane, float v) {
  lanes[lane] = v;
}
/// Of a body that turns alike about every axis.
template <int W>
void set_lane(float (&lanes)[W], int lane, const Mat3f& m) {
  lanes[lane] = m.cx.x;
}

}  // namespace carom::rigid::detail
