// Drag tables and motor files from anybody: curves whose every value is finite, or a clear error that names the place.
#include <cstdint>
#include <string_view>

#include "carom/ballistics/drag_curve.h"
#include "carom/ballistics/motor.h"
#include "tests/fuzz/require.h"
#include "tests/fuzz/target.h"

FUZZ_TARGET(ballistics) {
  using namespace carom;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto curve = ballistics::read_drag_table(text, "f");
  require(curve.ok() || curve.error().message.starts_with("f"), "an error that does not name the file");
  if (curve)
    for (const double mach : {0.0, 0.3, 0.99, 1.0, 1.7, 5.0, 1e6})
      require(math::is_finite((*curve)(mach)) && (*curve)(mach) >= 0, "a drag that cannot be");
  // The same numbers as coefficients that hold from a Mach number upward.
  if (curve) {
    std::vector<ballistics::BallisticCoefficientBand> bands;
    for (const ballistics::DragPoint& p : curve->points()) bands.push_back({p.mach, p.coefficient});
    const auto banded = ballistics::banded_drag(ballistics::drag_table(ballistics::DragFunction::g7), bands, 0.5);
    if (banded)
      for (const double mach : {0.0, 0.5, 1.0, 2.5, 9.0})
        require(math::is_finite((*banded)(mach)) && (*banded)(mach) >= 0, "a drag of bands that cannot be");
  }
  const auto motors = ballistics::read_rasp(text, "f");
  require(motors.ok() || motors.error().message.starts_with("f:"), "an error that does not name the file");
  if (motors)
    for (const ballistics::Motor& motor : *motors) {
      double before = 0;
      for (int i = 0; i <= 20; ++i) {
        const double impulse = motor.curve.impulse(motor.curve.burn_time() * i / 20);
        require(impulse >= before * (1 - 1e-12) && math::is_finite(impulse), "an impulse that falls");
        before = impulse;
      }
    }
}
