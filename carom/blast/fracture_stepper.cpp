#include "carom/blast/structure.h"

namespace carom::blast {

template <class D>
core::Status FractureStepper<D>::step(rigid::World<D>& world, float dt, std::span<Structure<D>* const> structures) {
  bool can_break = false;
  for (Structure<D>* s : structures) {
    s->start_step();
    can_break = can_break || s->can_break();
  }
  for (rounds_ = 1;; ++rounds_) {
    const bool last = !can_break || rounds_ == most_rounds;
    if (!last) world.snapshot(before_);
    if (auto s = world.step(dt); !s) return s;
    bool again = false;
    for (Structure<D>* s : structures) {
      const auto by_contacts = s->find_breaks(world, dt);
      if (!by_contacts.ok()) return by_contacts.error();
      again = again || *by_contacts;
    }
    if (last) again = false;
    if (again) {
      if (auto s = world.restore(before_); !s) return s;
      for (Structure<D>* s : structures)
        if (auto status = s->bear(world); !status) return status;
    } else if (can_break) {
      for (Structure<D>* s : structures)
        if (auto status = s->give_back(world); !status) return status;
    }
    for (Structure<D>* s : structures)
      if (auto status = s->part_bodies(world); !status) return status;
    if (!again) return {};
  }
}

template class FractureStepper<rigid::Dim2>;
template class FractureStepper<rigid::Dim3>;

}  // namespace carom::blast
