// The waves of charges by the logarithm of the scaled distance, as pieces of polynomials.
#pragma once

#include <vector>

#include "carom/blast/wave.h"

namespace carom::blast::detail {

/// What `blast_wave` says, to 1e-7, in a twentieth of its time.
class WaveTable {
 public:
  static const WaveTable& of(Burst burst);
  /// `z` in m/kg^{1/3} of the charge that the ground's fits are asked for, `scale` its mass^{1/3}.
  Wave at(double z, double scale) const;

 private:
  static constexpr int quantities = 9, points = 6;
  struct Piece {
    double of[points][quantities];  // by powers of −1 … 1
  };
  /// Between two places where a fit, or the way in which a decay is found, ends.
  struct Stretch {
    double end = 0;          // z
    double start = 0;        // ln z
    double pieces_each = 0;  // per ln z
    int first = 0, count = 0;
  };
  explicit WaveTable(Burst burst);
  std::vector<Stretch> stretches_;
  std::vector<Piece> pieces_;
};

/// Where the fits of a wave end, in order, within the range of all.
std::vector<double> ends_of_fits();

}  // namespace carom::blast::detail
