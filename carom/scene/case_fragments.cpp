#include "carom/scene/case_fragments.h"

#include "carom/core/string.h"

namespace carom::scene {

core::Status check(const CaseDef& d) {
  const auto positive = [](double x) { return x > 0 && math::is_finite(x); };
  const struct {
    const char* name;
    double value;
  } fields[] = {
      {"mass", d.mass}, {"density", d.density}, {"lifetime", d.lifetime}, {"gurney_constant", d.gurney_constant}};
  for (const auto& field : fields)
    if (!positive(field.value)) return core::Error{core::refused(field.name, field.value, "a finite number > 0")};
  if (!(d.drag_coefficient >= 0) || !math::is_finite(d.drag_coefficient))
    return core::Error{core::refused("drag_coefficient", d.drag_coefficient, "a finite number >= 0")};
  if (d.fragments < 2 || d.fragments > 100'000)
    return core::Error{core::refused("fragments", d.fragments, "2 to 100 000")};
  return {};
}

CaseFragments::CaseFragments(const CaseDef& definition, const ballistics::Conditions& conditions)
    : definition_(definition), batch_(ballistics::DragCurve(definition.drag_coefficient), conditions) {}

core::Status CaseFragments::fly_apart(math::Vec3d place, math::Vec3d velocity, double charge, double time) {
  thrown_ = true;
  thrown_at_ = time;
  const double speed = blast::gurney_speed(definition_.shape, definition_.mass / charge, definition_.gurney_constant);
  const auto spray = blast::fragment_spray(definition_.mass, speed, definition_.fragments, definition_.seed);
  if (!spray) return spray.error();
  for (const blast::Fragment& fragment : *spray)
    batch_.add({place, velocity + fragment.velocity}, ballistics::chunk_round(fragment.mass, definition_.density));
  return {};
}

void CaseFragments::forget_old(double now) {
  if (thrown_ && now - thrown_at_ > definition_.lifetime) batch_.clear();
}

void CaseFragments::add_to(core::StateHash& hash) const {
  hash.add(hits).add(thrown_);
  for (int component = 0; component < 6; ++component)
    for (const float x : batch_.array(component)) hash.add(x);
}

}  // namespace carom::scene
