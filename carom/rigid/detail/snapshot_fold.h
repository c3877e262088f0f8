// What of a snapshot follows from the rest of it, so that a difference need not carry it.
#pragma once

#include <cstddef>
#include <cstring>

#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/snapshot_data.h"

namespace carom::rigid::detail {

template <class T>
void exclusive_or(T& x, const T& y) {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % 4 == 0);
  std::uint32_t a[sizeof(T) / 4], b[sizeof(T) / 4];
  std::memcpy(a, &x, sizeof(T));
  std::memcpy(b, &y, sizeof(T));
  for (std::size_t i = 0; i < sizeof(T) / 4; ++i) a[i] ^= b[i];
  std::memcpy(static_cast<void*>(&x), a, sizeof(T));
}

/// Combines the position of the origin with what the centre of mass says of it, and the inverse inertia with what the
/// attitude says: both become zero where they agree to the bit. Done twice, it undoes itself: lossless.
template <class D>
void fold_body(typename D::Pose& pose, BodyMotion<D>& motion, const BodyRecord& record) {
  exclusive_or(pose.position, motion.center - typename D::Position(rotate(pose.rotation, motion.local_center)));
  exclusive_or(motion.world_inverse_inertia, inverse_inertia_in_world(motion, pose.rotation, record));
}

/// The image without what manifolds of awake bodies only report of the last step (impulses in all, speeds):
/// the next step writes them anew and nothing reads them before.
template <class D>
std::vector<std::uint64_t> canonical_image(const SnapshotData<D>& data) {
  std::vector<std::uint64_t> image = data.image;
  std::byte* const manifolds = section_values<std::byte>(image, data, data.manifolds_at);
  for (std::size_t i = 0; i < data.sections[data.manifolds_at].count; ++i) {
    ManifoldRecord<D> m;  // an image is not aligned as records are
    std::byte* const at = manifolds + i * sizeof m;
    std::memcpy(static_cast<void*>(&m), at, sizeof m);
    if (m.contact == none || m.place.color < 0) continue;
    for (float& total : m.impulses.total) total = 0;
    m.impulses.friction_total = {};
    m.approach_speed = m.slip_speed = 0;
    std::memcpy(at, &m, sizeof m);
  }
  return image;
}

/// Folds the bodies of `image` for which `changed(slot)`.
template <class D, class Changed>
void fold_bodies(std::vector<std::uint64_t>& image, const SnapshotData<D>& data, Changed&& changed) {
  auto* const pose = section_values<typename D::Pose>(image, data, data.bodies_at + 1);
  auto* const motion = section_values<BodyMotion<D>>(image, data, data.bodies_at + 2);
  auto* const record = section_values<BodyRecord>(image, data, data.bodies_at + 3);
  for (std::size_t i = 0; i < data.sections[data.bodies_at].count; ++i)
    if (changed(i)) fold_body<D>(pose[i], motion[i], record[i]);
}

/// Where the base of a difference is one step old, it tells to the bit how the shapes of most contacts stood to each
/// other when that step looked at them: ContactRecord::base need not be sent.
template <class D>
class ContactForesight {
 public:
  /// The images as canonical_image makes them; `base` and its image must stay.
  ContactForesight(const SnapshotData<D>& data, const SnapshotData<D>& base,
                   const std::vector<std::uint64_t>& base_image)
      : data_(data), base_(base), base_image_(base_image) {}

  /// Calls f(place of the contact's base in `image`, what it is foreseen to be) for the contacts of `image` whose
  /// bodies and shapes there are, by what else than `base` the records say.
  template <class F>
  void for_each(std::vector<std::uint64_t>& image, F&& f) const {
    const SnapshotSection &contacts = data_.sections[data_.manifolds_at - 1], &shapes = data_.sections[data_.shapes_at],
                          &poses = base_.sections[base_.bodies_at + 1];
    for (std::size_t i = 0; i < contacts.count; ++i) {
      std::byte* const at =
          section_values<std::byte>(image, data_, data_.manifolds_at - 1) + i * sizeof(ContactRecord<D>);
      ContactRecord<D> c;
      std::memcpy(static_cast<void*>(&c), at, sizeof c);
      if ((c.flags & contact_in_use) == 0) continue;
      typename D::Pose pose[2];
      bool there = true;
      for (int side = 0; side < 2 && there; ++side) {
        const std::size_t body = std::size_t(c.body[side]), shape = std::size_t(c.shape[side]);
        there = c.body[side] >= 0 && body < poses.count && c.shape[side] >= 0 && shape < shapes.count;
        if (!there) break;
        std::memcpy(static_cast<void*>(&pose[side]),
                    reinterpret_cast<const std::byte*>(base_image_.data() + poses.first) + body * sizeof pose[side],
                    sizeof pose[side]);
        typename D::Transform local;
        static_assert(std::is_base_of_v<ShapeTraits<D>, ShapeRecord<D>> && offsetof(ShapeTraits<D>, local) == 0);
        std::memcpy(static_cast<void*>(&local),
                    reinterpret_cast<const std::byte*>(image.data() + shapes.first) + shape * sizeof(ShapeTraits<D>),
                    sizeof local);
        if (!(local == typename D::Transform{})) pose[side] = pose[side] * local;
      }
      if (there) f(at + offsetof(ContactRecord<D>, base), typename D::Transform(relative(pose[0], pose[1])));
    }
  }

 private:
  const SnapshotData<D>& data_;
  const SnapshotData<D>& base_;
  const std::vector<std::uint64_t>& base_image_;
};

}  // namespace carom::rigid::detail
