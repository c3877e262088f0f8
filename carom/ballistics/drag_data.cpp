#include "carom/ballistics/drag_data.h"

#include "carom/core/string.h"

namespace carom::ballistics {
namespace {

core::Status check(std::string_view name, double value, bool zero_too) {
  if (math::is_finite(value) && (value > 0 || (zero_too && value == 0))) return {};
  return core::Error{core::refused(name, value, zero_too ? "a finite number >= 0" : "a finite number > 0")};
}

}  // namespace

core::Result<Projectile> projectile_from(const DragData& data, double mass, double diameter) {
  if ((data.function ? 1 : 0) + (data.coefficient ? 1 : 0) + (data.table.empty() ? 0 : 1) != 1)
    return core::Error{"expected one of drag_function, drag_coefficient and drag_table"};
  if (auto s = check("form_factor", data.form_factor, false); !s) return s.error();
  if (data.ballistic_coefficient && !data.bands.empty())
    return core::Error{"expected either ballistic_coefficient or ballistic_coefficients"};
  if (data.coefficient && (data.ballistic_coefficient || !data.bands.empty()))
    return core::Error{"expected drag_function or drag_table beside a ballistic_coefficient, not drag_coefficient"};

  DragCurve curve;
  if (data.coefficient) {
    if (auto s = check("drag_coefficient", *data.coefficient, true); !s) return s.error();
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
    if (auto s = check("ballistic_coefficient", coefficient, false); !s) return s.error();
    Projectile projectile = projectile_from_coefficient(DragFunction::g1, coefficient);
    projectile.drag = std::move(curve);
    projectile.area_per_mass *= data.form_factor;
    return projectile;
  }
  if (auto s = check("mass", mass, false); !s) return s.error();
  if (auto s = check("diameter", diameter, false); !s) return s.error();
  return projectile_from_size(std::move(curve), mass, diameter, data.form_factor);
}

}  // namespace carom::ballistics
