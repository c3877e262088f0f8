#include "carom/blast/detail/wave_table.h"

#include <algorithm>

#include "carom/math/elementary.h"

namespace carom::blast::detail {

namespace {

/// Of the charge whose scale is 1.
Wave wave_of_unit(double z, Burst burst) { return *blast_wave(burst == Burst::ground ? 1 : 1.8, z, burst); }

using Values = double[9];
void values_of(const Wave& w, Values& out) {
  const double all[] = {w.arrival,     w.pressure, w.reflected_pressure, w.duration, w.impulse, w.reflected_impulse,
                        w.front_speed, w.decay,    w.reflected_decay};
  std::copy(std::begin(all), std::end(all), out);
}

/// 0: a decay of none, 2: the most that is looked for.
int kind_of_decay(double decay) { return decay <= 0 ? 0 : decay >= 200 ? 2 : 1; }

}  // namespace

const WaveTable& WaveTable::of(Burst burst) {
  static const WaveTable ground(Burst::ground), air(Burst::free_air);
  return burst == Burst::ground ? ground : air;
}

WaveTable::WaveTable(Burst burst) {
  constexpr double least = least_scaled_distance * (1 + 1e-12), most = greatest_scaled_distance * (1 - 1e-12);
  std::vector<double> ends = ends_of_fits();
  for (double Wave::* decay : {&Wave::decay, &Wave::reflected_decay}) {
    const auto kind = [&](double z) { return kind_of_decay(wave_of_unit(z, burst).*decay); };
    constexpr int looks = 400;
    const double step = math::exp(math::log(most / least) / looks);
    double low = least;
    for (int i = 0; i < looks; ++i) {
      const double high = math::min(low * step, most);
      double a = low, b = high;
      if (kind(a) != kind(b)) {
        for (int k = 0; k < 60; ++k) (kind(0.5 * (a + b)) == kind(low) ? a : b) = 0.5 * (a + b);
        ends.push_back(a);
      }
      low = high;
    }
  }
  ends.push_back(most);
  std::sort(ends.begin(), ends.end());

  double nodes[points];
  for (int i = 0; i < points; ++i) nodes[i] = -math::cos(math::pi * (i + 0.5) / points);
  double begin = least;
  for (const double end : ends) {
    if (!(end > begin * (1 + 1e-9))) continue;
    const double width = math::log(end / begin);
    Stretch s{end, math::log(begin), 0, int(pieces_.size()), int(width / 0.08) + 1};
    s.pieces_each = s.count / width;
    for (int k = 0; k < s.count; ++k) {
      Piece piece{};
      double divided[points][quantities];
      for (int i = 0; i < points; ++i) {
        const double x = s.start + (k + 0.5 * (nodes[i] + 1)) / s.pieces_each;
        values_of(wave_of_unit(math::clamp(math::exp(x), begin * (1 + 1e-13), end), burst), divided[i]);
      }
      // Newton's divided differences, multiplied out from the last.
      for (int order = 1; order < points; ++order)
        for (int i = points - 1; i >= order; --i)
          for (int q = 0; q < quantities; ++q)
            divided[i][q] = (divided[i][q] - divided[i - 1][q]) / (nodes[i] - nodes[i - order]);
      for (int i = points - 1; i >= 0; --i)
        for (int q = 0; q < quantities; ++q) {
          for (int p = points - 1; p > 0; --p) piece.of[p][q] = piece.of[p - 1][q] - nodes[i] * piece.of[p][q];
          piece.of[0][q] = divided[i][q] - nodes[i] * piece.of[0][q];
        }
      pieces_.push_back(piece);
    }
    stretches_.push_back(s);
    begin = end;
  }
}

Wave WaveTable::at(double z, double scale) const {
  const Stretch* s = stretches_.data();
  while (z > s->end && s != &stretches_.back()) ++s;
  const double along = (math::log(z) - s->start) * s->pieces_each;
  const int k = math::clamp(int(along), 0, s->count - 1);
  const double t = 2 * (along - k) - 1;
  const Piece& piece = pieces_[std::size_t(s->first) + std::size_t(k)];
  double v[quantities];
  for (int q = 0; q < quantities; ++q) v[q] = piece.of[points - 1][q];
  for (int p = points - 2; p >= 0; --p)
    for (int q = 0; q < quantities; ++q) v[q] = v[q] * t + piece.of[p][q];
  return {scale * v[0],        v[1], v[2], scale * v[3], scale * v[4], scale * v[5], v[6], math::max(v[7], 0.0),
          math::max(v[8], 0.0)};
}

}  // namespace carom::blast::detail
