#include "carom/blast/reflection.h"

#include <optional>

#include "carom/blast/wave.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {
namespace {

constexpr double gamma = 1.4;

/// A steady oblique shock: what it makes of a flow of Mach number M that meets it under the angle β.
struct Oblique {
  double ratio = 1;       // of the pressures
  double deflection = 0;  // rad
  double mach = 0;        // behind it
};
std::optional<Oblique> oblique(double mach, double beta) {
  const double sine = math::sin(beta), square = math::square(mach * sine);
  if (!(square > 1)) return {};
  Oblique o;
  o.ratio = 1 + 2 * gamma / (gamma + 1) * (square - 1);
  const double cosine = math::cos(beta);
  o.deflection = math::atan2(2 * cosine * (square - 1), sine * (mach * mach * (gamma + math::cos(2 * beta)) + 2));
  o.mach = math::sqrt((1 + 0.5 * (gamma - 1) * square) / (gamma * square - 0.5 * (gamma - 1))) /
           math::sin(beta - o.deflection);
  return o;
}
/// The shock angle of the greatest deflection (NACA Report 1135, 1953).
double strongest_turn(double mach) {
  const double m2 = mach * mach;
  const double sine2 =
      ((gamma + 1) * m2 - 4 + math::sqrt((gamma + 1) * ((gamma + 1) * m2 * m2 + 8 * (gamma - 1) * m2 + 16))) /
      (4 * gamma * m2);
  return math::asin(math::sqrt(math::min(1.0, sine2)));
}

double shock_mach(double excess) { return math::sqrt(1 + (gamma + 1) / (2 * gamma) * excess); }
double shock_excess(double mach) { return 2 * gamma / (gamma + 1) * (mach * mach - 1); }

/// Whether a reflected shock can turn the flow back along the ground.
bool can_turn_back(const std::optional<Oblique>& first) {
  if (!first || !(first->mach > 1)) return false;
  const auto most = oblique(first->mach, strongest_turn(first->mach));
  return most && most->deflection >= first->deflection;
}

/// Both by `excess` = P_s/P₀. The point of reflection runs along the ground at U/sin α.
std::optional<double> regular(double excess, double incidence) {
  if (incidence < 1e-4) return ideal_reflected_pressure(excess, 1) / excess;
  const auto first = oblique(shock_mach(excess) / math::sin(incidence), incidence);
  if (!can_turn_back(first)) return {};
  double low = math::asin(1 / first->mach), high = strongest_turn(first->mach);
  for (int i = 0; i < 45; ++i) {  // the weaker of the two shocks that turn it back
    const double middle = 0.5 * (low + high);
    const auto shock = oblique(first->mach, middle);
    (shock && shock->deflection >= first->deflection ? high : low) = middle;
  }
  const auto second = oblique(first->mach, high);
  return second ? std::optional((first->ratio * second->ratio - 1) / excess) : std::nullopt;
}

double detachment(double excess) {
  double low = 0.1, high = 0.5 * math::pi;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (can_turn_back(oblique(shock_mach(excess) / math::sin(middle), middle)) ? low : high) = middle;
  }
  return low;
}

struct Stem {
  double factor = 1, angle = 0;
};

/// What the flows on both sides of the slip line are apart in direction, where the path of the triple point rises by
/// χ: there the upstream flow comes with U/sin(α − χ), and the stem is square to the ground.
struct TriplePoint {
  double apart = 0, ratio = 1;
};
std::optional<TriplePoint> triple_point(double mach, double incidence, double chi) {
  const double upstream = mach / math::sin(incidence - chi);
  const auto incident = oblique(upstream, incidence - chi), stem = oblique(upstream, 0.5 * math::pi - chi);
  if (!incident || !stem || !(incident->mach > 1)) return {};
  const double rise = stem->ratio / incident->ratio;
  if (rise < 1) return {};
  const double sine2 = ((rise - 1) * (gamma + 1) / (2 * gamma) + 1) / math::square(incident->mach);
  if (sine2 > 1) return {};
  const auto reflected = oblique(incident->mach, math::asin(math::sqrt(sine2)));
  return TriplePoint{incident->deflection - (reflected ? reflected->deflection : 0) - stem->deflection, stem->ratio};
}
std::optional<Stem> three_shocks(double excess, double incidence) {
  const double mach = shock_mach(excess);
  constexpr int parts = 60;
  std::optional<TriplePoint> before;
  for (int k = 1; k < parts; ++k) {
    const double chi = incidence * k / parts;
    const auto here = triple_point(mach, incidence, chi);
    if (here && before && before->apart * here->apart <= 0) {
      double low = incidence * (k - 1) / parts, high = chi;
      for (int i = 0; i < 30; ++i) {
        const double middle = 0.5 * (low + high);
        const auto there = triple_point(mach, incidence, middle);
        (there && there->apart * before->apart > 0 ? low : high) = middle;
      }
      const auto found = triple_point(mach, incidence, low);
      return Stem{((found ? found->ratio : here->ratio) - 1) / excess, low};
    }
    before = here;
  }
  return {};
}

/// ln A of a ray tube by the Mach number: dA/A = −2 M dM/((M² − 1) K(M)), Chester's K as Whitham has it.
double area_rate(double mach) {
  const double m2 = mach * mach, mu2 = ((gamma - 1) * m2 + 2) / (2 * gamma * m2 - (gamma - 1)), mu = math::sqrt(mu2);
  const double k = 2 / ((1 + 2 / (gamma + 1) * (1 - mu2) / mu) * (2 * mu + 1 + 1 / m2));
  return -2 * mach / ((m2 - 1) * k);
}
/// Whitham's shock-shock: a plane shock that runs along a wall which turns up by π/2 − α.
Stem ray_shock(double excess, double incidence) {
  const double mach = shock_mach(excess), wall = 0.5 * math::pi - incidence;
  const double begin = math::log(mach - 1);
  // ∫ d ln A over ln(M − 1) by Simpson's rule, carried on from one bracket to the next.
  const auto part = [](double from, double to) {
    const auto at = [](double u) {
      const double over = math::exp(u);
      return area_rate(1 + over) * over;
    };
    return (to - from) / 6 * (at(from) + 4 * at(0.5 * (from + to)) + at(to));
  };
  const auto turn = [&](double stem, double area) {
    const double r = stem / mach;
    return math::atan(math::sqrt(math::max(0.0, r * r - 1)) * math::sqrt(1 - area * area) / (area + r));
  };
  double low = begin, sum = 0, step = 0.25;
  double stem = mach, area = 1;
  for (int i = 0; i < 200 && step > 1e-7; ++i) {
    const double more = part(low, low + step), next = 1 + math::exp(low + step), tube = math::exp(sum + more);
    if (turn(next, tube) > wall) {
      step *= 0.25;
      continue;
    }
    low += step, sum += more, stem = next, area = tube;
    if (shock_excess(stem) > 20 * excess) break;  // beyond any reflection
  }
  if (area >= 1) return {};
  const double r = stem / mach;
  return {shock_excess(stem) / excess, math::atan(area * math::sqrt((1 - 1 / (r * r)) / (1 - area * area)))};
}

}  // namespace

double greatest_regular_incidence(double side_on, double ambient) {
  return side_on > 0 && ambient > 0 ? detachment(side_on / ambient) : 0.5 * math::pi;
}

core::Result<ShockReflection> reflect(double side_on, double incidence, double ambient) {
  if (!(side_on > 0) || !math::is_finite(side_on))
    return core::Error{core::refused("reflect: side_on", side_on, "a finite pressure > 0 Pa")};
  if (!(ambient > 0) || !math::is_finite(ambient))
    return core::Error{core::refused("reflect: ambient", ambient, "a finite pressure > 0 Pa")};
  if (!(incidence >= 0 && incidence <= 0.5 * math::pi + 1e-12))
    return core::Error{core::refused("reflect: incidence", incidence, "0 to pi/2 rad")};
  // Below a thousandth of an atmosphere a shock is sound to the theory's rounding.
  const double excess = math::max(side_on / ambient, 1e-3);
  if (const auto factor = regular(excess, incidence)) return ShockReflection{*factor, false, 0};
  const double most = regular(excess, detachment(excess)).value_or(2);
  if (incidence > 0.5 * math::pi - 1e-3) return ShockReflection{1, true, 0};
  const auto triple = three_shocks(excess, incidence);
  const Stem stem = triple ? *triple : ray_shock(excess, incidence);
  return ShockReflection{math::max(1.0, math::min(most, stem.factor)), true, stem.angle};
}

}  // namespace carom::blast
