#include "apps/host/demos/figures/balance.h"

#include "carom/math/rotation.h"

namespace carom::host::demo {

void Balance::look(Stage3& stage, const Figure& figure) {
  const Vec3d feet =
      0.5 * (stage.at(figure.body[Figure::foot]).pose.position + stage.at(figure.body[Figure::foot + 1]).pose.position);
  const Vec3d center = figure.mechanism.center_of_mass(), away = center - feet;
  // x + v/ω: where a pendulum of that height must be held to come to rest over it.
  const double omega = sqrt(9.80665 / max(away.y, 0.2));
  const Vec3d capture = away + Vec3d(figure.mechanism.center_velocity()) * (1 / omega);
  const Vec3d ahead = rotate(Quatd(stage.at(figure.body[Figure::pelvis]).pose.rotation), Vec3d{1, 0, 0});
  const double level = max(sqrt(ahead.x * ahead.x + ahead.z * ahead.z), 1e-6);
  forward = (capture.x * ahead.x + capture.z * ahead.z) / level;
  aside = (capture.z * ahead.x - capture.x * ahead.z) / level;
}

void Balance::correct(Pose& pose, double gain) const {
  const double tip = clamp(gain * forward, -0.5, 0.5), lean = clamp(gain * aside, -0.3, 0.3);
  for (int k = 0; k < 2; ++k) {
    pose.ankle[k].z -= tip;  // toes down
    pose.ankle[k].x += lean;
    pose.hip[k].x -= lean;  // the legs stay parallel, the hips go over to the other side
  }
}

}  // namespace carom::host::demo
