// What of a snapshot follows from the rest of it, so that a difference need not carry it.
#pragma once

#include <cstddef>
#include <cstring>

#include "carom/rigid/detail/bodies.h"
#include "carom/rigid/detail/pair_set.h"
#include "carom/rigid/detail/rotation_step.h"
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

/// The image without what manifolds of awake bodies only report of the last step (impulses in all, speeds), which the
/// next step writes anew and nothing reads before, and without the set of pairs, which the contacts tell.
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
  const SnapshotSection& pairs = data.sections[data.pairs_at];
  std::fill_n(image.begin() + std::ptrdiff_t(pairs.first), pairs.count, std::uint64_t{0});
  return image;
}

/// Writes the set of pairs of the contacts into the image. False where it cannot be one.
template <class D>
bool write_pairs(SnapshotData<D>& data) {
  const SnapshotSection &contacts = data.sections[data.manifolds_at - 1], &pairs = data.sections[data.pairs_at];
  const auto count = std::size_t(pairs.count);
  if ((count & (count - 1)) != 0) return false;
  PairSet set;
  PairSet::visit_members(set, [&]<class T>(T& member) {
    if constexpr (std::is_same_v<T, std::vector<std::uint64_t>>) member.resize(count);
  });
  set.clear();
  for (std::size_t i = 0; i < contacts.count; ++i) {
    ContactRecord<D> c;
    std::memcpy(static_cast<void*>(&c),
                section_values<std::byte>(data.image, data, data.manifolds_at - 1) + i * sizeof c, sizeof c);
    if ((c.flags & contact_in_use) == 0) continue;
    if (c.shape[0] == c.shape[1] || 4 * (set.size() + 1) > 3 * count) return false;
    set.insert(PairSet::key(c.shape[0], c.shape[1]));
  }
  PairSet::visit_members(set, [&]<class T>(T& member) {
    if constexpr (std::is_same_v<T, std::vector<std::uint64_t>>)
      std::copy(member.begin(), member.end(), data.image.begin() + std::ptrdiff_t(pairs.first));
  });
  return true;
}

/// A node of DynamicTree, as it lies in an image.
template <class D>
struct TreeNodeImage {
  typename D::Bounds box;
  std::int32_t parent, child_a, child_b;  ///< child_b < 0: a leaf
  std::uint32_t enlarged;
};

/// Combines the boxes of inner nodes with those of their children, which they mostly are about: from the root down, or
/// back from the leaves up. What is no tree stays as it is.
template <class D>
void fold_trees(std::vector<std::uint64_t>& image, const SnapshotData<D>& data, bool back) {
  using Node = TreeNodeImage<D>;
  static_assert(std::is_trivially_copyable_v<Node>);
  constexpr std::size_t trees = 3, sections_of_tree = 5;
  for (std::size_t t = 0; t < trees; ++t) {
    const std::size_t at = data.trees_at + t * sections_of_tree;
    const auto count = std::size_t(data.sections[at].count);
    std::byte* const nodes = section_values<std::byte>(image, data, at);
    const auto node_at = [&](std::size_t i) {
      Node node;
      std::memcpy(static_cast<void*>(&node), nodes + i * sizeof node, sizeof node);
      return node;
    };
    std::vector<std::size_t> inner, open;  // parents before children
    std::vector<bool> met(count);
    bool sound = true;
    const auto open_node = [&](std::int32_t i) {
      sound = sound && i >= 0 && std::size_t(i) < count && !met[std::size_t(i)];
      if (!sound) return;
      met[std::size_t(i)] = true;
      open.push_back(std::size_t(i));
    };
    std::int32_t root;
    std::memcpy(&root, section_values<std::byte>(image, data, at + 1), sizeof root);
    if (root >= 0) open_node(root);
    while (sound && !open.empty()) {
      const std::size_t i = open.back();
      open.pop_back();
      const Node node = node_at(i);
      if (node.child_b < 0) continue;
      inner.push_back(i);
      open_node(node.child_a), open_node(node.child_b);
    }
    if (!sound) continue;
    if (back) std::reverse(inner.begin(), inner.end());
    for (const std::size_t i : inner) {
      Node node = node_at(i);
      exclusive_or(node.box, merge(node_at(std::size_t(node.child_a)).box, node_at(std::size_t(node.child_b)).box));
      std::memcpy(nodes + i * sizeof node, static_cast<const void*>(&node), sizeof node);
    }
  }
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

/// Where bodies come to from a base by the velocities that they have in both: as if they gathered speed evenly, over
/// four substeps a step. What is sent is how they differ from that.
template <class D>
class BodyForesight {
 public:
  using Way = typename D::Vector;

  /// `image` holds the velocities already; the base's image must stay.
  BodyForesight(const std::vector<std::uint64_t>& image, const SnapshotData<D>& data, const SnapshotData<D>& base,
                const std::vector<std::uint64_t>& base_image)
      : now_(velocities(image, data)),
        before_(velocities(base_image, base)),
        span_(float(time_of(image, data) - time_of(base_image, base))) {
    const double steps = data.step_count > base.step_count ? double(data.step_count - base.step_count) : 1;
    share_ = float(0.5 + 0.125 / steps);
  }
  typename D::Rotation rotation(std::size_t body, const typename D::Rotation& from) const {
    const SolverBody<D> a = velocity(before_, body), b = velocity(now_, body);
    const auto mean = a.angular_velocity + (b.angular_velocity - a.angular_velocity) * share_;
    const typename D::Rotation turned = turn(mean * span_) * from;
    return is_finite(turned) ? normalize(turned) : from;
  }
  Way way(std::size_t body) const {
    const SolverBody<D> a = velocity(before_, body), b = velocity(now_, body);
    return (a.linear_velocity + (b.linear_velocity - a.linear_velocity) * share_) * span_;
  }

 private:
  static const std::byte* velocities(const std::vector<std::uint64_t>& image, const SnapshotData<D>& data) {
    return reinterpret_cast<const std::byte*>(image.data() + data.sections[data.bodies_at].first);
  }
  static SolverBody<D> velocity(const std::byte* all, std::size_t body) {
    SolverBody<D> s;
    std::memcpy(static_cast<void*>(&s), all + body * sizeof s, sizeof s);
    return s;
  }
  /// s; the last but one of the sections.
  static double time_of(const std::vector<std::uint64_t>& image, const SnapshotData<D>& data) {
    double time = 0;
    if (data.sections.size() > 1) std::memcpy(&time, &image[data.sections[data.sections.size() - 2].first], 8);
    return time;
  }
  const std::byte *now_, *before_;
  float span_, share_;
};

/// The same word of three records, all of plain words: x ⊕ from ⊕ foreseen, which done again gives x back.
template <class T>
void tell_by(T& x, const T& from, const T& foreseen) {
  exclusive_or(x, from);
  exclusive_or(x, foreseen);
}

/// An attitude by the foreseen one, but its largest number by what the others leave of a unit.
template <class R>
void tell_rotation(R& rotation, const R& from, const R& foreseen, bool back) {
  constexpr std::size_t size = sizeof(R) / sizeof(float);
  float now[size], before[size], expected[size];
  std::memcpy(now, &rotation, sizeof now);
  std::memcpy(before, &from, sizeof before);
  std::memcpy(expected, &foreseen, sizeof expected);
  std::size_t largest = 0;
  for (std::size_t k = 1; k < size; ++k)
    if (math::abs(expected[k]) > math::abs(expected[largest])) largest = k;
  const auto tell_others = [&] {
    for (std::size_t k = 0; k < size; ++k)
      if (k != largest) tell_by(now[k], before[k], expected[k]);
  };
  if (back) tell_others();
  float rest = 1;
  for (std::size_t k = 0; k < size; ++k)
    if (k != largest) rest -= now[k] * now[k];
  if (rest > 0) expected[largest] = expected[largest] < 0 ? -math::sqrt(rest) : math::sqrt(rest);
  tell_by(now[largest], before[largest], expected[largest]);
  if (!back) tell_others();
  std::memcpy(static_cast<void*>(&rotation), now, sizeof now);
}

/// The centre of mass as its way from that of the base: exactly a float for each axis mostly, of which the difference
/// to the foreseen one is told; the high words are free then. Returns whether it was so.
template <class P, class V>
bool tell_center_by_way(P& center, const P& from, const V& foreseen) {
  const V way(center - from);
  if (!(from + P(way) == center)) return false;
  for (std::size_t k = 0; k < sizeof(P) / sizeof(double); ++k)
    if (center[int(k)] == 0) return false;  // −0 is not 0 to the bit
  P told = from;
  V difference = way;
  exclusive_or(difference, foreseen);
  std::uint32_t words[sizeof(P) / 4], ways[sizeof(V) / 4];
  std::memcpy(words, &told, sizeof told);
  std::memcpy(ways, &difference, sizeof difference);
  for (std::size_t k = 0; k < sizeof(V) / 4; ++k) words[k] ^= ways[k];
  std::memcpy(static_cast<void*>(&center), words, sizeof center);
  return true;
}
template <class P, class V>
void center_by_way(P& center, const P& from, const V& foreseen) {
  exclusive_or(center, from);
  V way;
  std::memcpy(static_cast<void*>(&way), static_cast<const void*>(&center), sizeof way);
  exclusive_or(way, foreseen);
  center = from + P(way);
}

}  // namespace carom::rigid::detail
