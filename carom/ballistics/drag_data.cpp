#include "carom/ballistics/drag_data.h"

#include "carom/ballistics/detail/number_checks.h"

namespace carom::ballistics {

core::Result<Projectile> projectile_from(const DragData& data, double mass, double diameter) {
  if ((data.function ? 1 : 0) + (data.coefficient ? 1 : 0) + (data.table.empty() ? 0 : 1) != 1)
    return core::Error{"expected one of drag_function, drag_coefficient and drag_table"};
  if (auto s = detail::check_numbers({{"form_factor", data.form_factor}}); !s) return s.error();
  if (data.ballistic_coefficient && !data.bands.empty())
    return core::Error{"expected either ballistic_coefficient or ballistic_coefficients"};
  if (data.coefficient && (data.ballistic_coefficient || !data.bands.empty()))
    return core::Error{"expected drag_function or drag_table beside a ballistic_coefficient, not drag_coefficient"};

  DragCurve curve;
  if (data.coefficient) {
    if (auto s = detail::check_numbers({{"drag_coefficient", *data.coefficient, true}}); !s) return s.error();
    curve = DragCurve(*data.coefficient);
  } else if (data.function) {
    curve = DragCurve(*data.function);
  } else {
    auto table = DragCurve::from_points(data.table);
    if (!table) return core::Error{core::text("drag_table: ", table.error().message)};
    curve = std::move(table).value();
  }
  if (!data.bands.empty()) {
    auto banded = banded_drag(curve.points(), data.bands, 1);
    if (!banded) return core::Error{core::text("ballistic_coefficients: ", banded.error().message)};
    curve = std::move(banded).value();
  }
  if (data.ballistic_coefficient || !data.bands.empty()) {
    const double coefficient = data.ballistic_coefficient.value_or(1);
    if (auto s = detail::check_numbers({{"ballistic_coefficient", coefficient}}); !s) return s.error();
    Projectile projectile = projectile_from_coefficient(DragFunction::g1, coefficient);
    projectile.drag = std::move(curve);
    projectile.area_per_mass *= data.form_factor;
    return projectile;
  }
  if (auto s = detail::check_numbers({{"mass", mass}, {"diameter", diameter}}); !s) return s.error();
  return projectile_from_size(std::move(curve), mass, diameter, data.form_factor);
}

}  // namespace carom::ballistics
