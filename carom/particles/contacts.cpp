#include "carom/particles/contacts.h"

#include <string>

#include "carom/math/vec.h"

namespace carom::particles {

core::Status check(const ContactDef& d) {
  if (!(d.restitution >= 0 && d.restitution <= 1))
    return core::Error{"contacts: restitution is " + std::to_string(d.restitution) + ", expected 0 to 1"};
  if (!(d.friction >= 0 && math::is_finite(d.friction)))
    return core::Error{"contacts: friction is " + std::to_string(d.friction) +
                       ", expected a finite number of at least 0"};
  if (d.substeps < 1 || d.substeps > 64)
    return core::Error{"contacts: substeps is " + std::to_string(d.substeps) + ", expected 1 to 64"};
  return {};
}

}  // namespace carom::particles
