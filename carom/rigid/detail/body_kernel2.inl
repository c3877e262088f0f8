// Bodies of the plane through a substep, side by side: part of contact_kernel.inl. The arithmetic of
// stage_integrate.cpp and rotation_step.h, operation for operation, so that it does not matter which of the two moves a
// body.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// W places of the list of awake bodies: what drives them, and who they are.
template <int W>
struct DrivenBodies2 {
  std::int32_t body[W];
  WideFloat<W> drive[8];

  CAROM_SIMD_INLINE explicit DrivenBodies2(const BodyDrive<Dim2>* drives) {
    const float* rows[W];
    for (int i = 0; i < W; ++i) {
      body[i] = drives[i].body;
      rows[i] = reinterpret_cast<const float*>(drives + i);
    }
    gather_rows<8, W>(rows, drive);
  }
  CAROM_SIMD_INLINE bool any_locked() const { return any(drive[7] > WideFloat<W>::splat(3)); }
  CAROM_SIMD_INLINE WideMask<W> dynamic() const { return drive[7] > WideFloat<W>::splat(0); }
  CAROM_SIMD_INLINE WideMask<W> carries() const { return drive[7] == WideFloat<W>::splat(2); }
  CAROM_SIMD_INLINE WideMask<W> in_flight() const { return drive[7] > WideFloat<W>::splat(2); }
};

/// Where the Flight<Dim2> of each lane is.
template <int W>
struct FlightRows2 {
  const float* row[W];
  CAROM_SIMD_INLINE explicit FlightRows2(const float* flights) {
    for (int i = 0; i < W; ++i) row[i] = flights + 8 * i;
  }
};

/// False, and nothing done, where a body's axes are locked.
template <int W>
bool integrate_velocities2(SolverBody<Dim2>* bodies, const BodyDrive<Dim2>* drives, float* flights, float h,
                           float max_speed, float max_turn, bool carry_on) {
  using F = WideFloat<W>;
  const DrivenBodies2<W> driven(drives);
  if (driven.any_locked()) return false;
  F row[8];
  gather_rows<8, W>(reinterpret_cast<const float*>(bodies), driven.body, row);
  const F one = F::splat(1), top = F::splat(max_speed), most = F::splat(max_turn);
  F x = (row[0] + driven.drive[4]) * driven.drive[2], y = (row[1] + driven.drive[5]) * driven.drive[2];
  F spin = (row[2] + driven.drive[6]) * driven.drive[3];
  const F speed2 = x * x + y * y;
  const auto fast = speed2 > top * top;
  const F slower = select(fast, top / sqrt(select(fast, speed2, one)), one);
  x *= slower;
  y *= slower;
  const F turn = abs(spin) * F::splat(h);
  const auto spins = turn > most;
  spin *= select(spins, most / select(spins, turn, one), one);
  const auto dynamic = driven.dynamic(), flies = driven.in_flight();
  const F share = F::splat(0.5f * h), zero = F::splat(0);
  const FlightRows2<W> rows(flights);
  const auto carries = driven.carries();
  const bool any_carry = any(carries);
  F carried[3] = {zero, zero, zero};
  if (carry_on && any_carry) {
    F last[8];
    gather_rows<8, W>(rows.row, last);
    carried[0] = select(carries, row[0] - last[0], zero);
    carried[1] = select(carries, row[1] - last[1], zero);
    carried[2] = select(carries, row[2] - last[4], zero);
  }
  const F moved[8] = {select(dynamic, x + carried[0], row[0]),
                      select(dynamic, y + carried[1], row[1]),
                      select(dynamic, spin + carried[2], row[2]),
                      row[3],
                      select(flies, row[4] + share * (row[0] + x), row[4]),
                      select(flies, row[5] + share * (row[1] + y), row[5]),
                      row[6],
                      row[7]};
  scatter_rows<8, 8, W>(reinterpret_cast<float*>(bodies), driven.body, moved);
  std::int32_t place[W];
  for (int i = 0; i < W; ++i) place[i] = i;
  if (any_carry) {
    const F flight[8] = {x, y, row[0], row[1], spin, zero, zero, zero};
    scatter_rows<8, 8, W>(flights, place, flight);
  } else {
    const F flight[4] = {x, y, row[0], row[1]};
    scatter_rows<8, 4, W>(flights, place, flight);
  }
  return true;
}

template <int W>
bool integrate_positions2(SolverBody<Dim2>* bodies, const BodyDrive<Dim2>* drives, const float* flights, float h) {
  using F = WideFloat<W>;
  const DrivenBodies2<W> driven(drives);
  if (driven.any_locked()) return false;
  F row[8], flight[4];
  gather_rows<8, W>(reinterpret_cast<const float*>(bodies), driven.body, row);
  gather_rows<4, W>(FlightRows2<W>(flights).row, flight);
  // What others are near but do not touch flies too: nothing has changed its velocity.
  const auto undisturbed = driven.dynamic() & (row[0] == flight[0]) & (row[1] == flight[1]);
  const F share = F::splat(0.5f * h), whole = F::splat(h), one = F::splat(1), zero = F::splat(0);
  const F x = select(undisturbed, share * (flight[2] + row[0]), whole * row[0]);
  const F y = select(undisturbed, share * (flight[3] + row[1]), whole * row[1]);
  const F half_turn = F::splat(0.5f) * (whole * row[2]), yy = half_turn * half_turn;
  const F t = half_turn * ((F::splat(105) - F::splat(10) * yy) / (F::splat(105) - F::splat(45) * yy + yy * yy));
  const F s = one / (one + t * t), turn_c = (one - t * t) * s, turn_s = F::splat(2) * t * s;
  const F c = turn_c * row[6] - turn_s * row[7], d = turn_s * row[6] + turn_c * row[7];
  const F length = sqrt(c * c + d * d);
  const auto turns = length > zero;
  const F divisor = select(turns, length, one);
  const auto flies = driven.in_flight();
  const F moved[4] = {select(flies, row[4], row[4] + x), select(flies, row[5], row[5] + y),
                      select(turns, c / divisor, one), select(turns, d / divisor, zero)};
  scatter_rows<8, 4, W>(reinterpret_cast<float*>(bodies) + 4, driven.body, moved);
  return true;
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
