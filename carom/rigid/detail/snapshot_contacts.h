// What of contacts follows from the base of a difference: where shapes stood when a step looked at them, what it found
// there, and where friction sticks.
#pragma once

#include "carom/geometry/manifold.h"
#include "carom/rigid/detail/snapshot_fold.h"

namespace carom::rigid::detail {

/// Tells contacts and manifolds of an image by what is foreseen of them, in words that are exclusive-or'ed with those
/// of the base. The base's image must be as canonical_image makes it. Indices are checked: an image that is being
/// decoded may hold any.
template <class D>
class ContactForesight {
 public:
  using Contact = ContactRecord<D>;
  using Record = ManifoldRecord<D>;
  using Vector = typename D::Vector;

  ContactForesight(std::vector<std::uint64_t>& image, const SnapshotData<D>& data, const SnapshotData<D>& base,
                   const std::vector<std::uint64_t>& base_image)
      : image_(image), data_(data), base_(base), base_image_(base_image) {}

  /// Returns what is told by foresight and what by the base, in the order in which `tell_back` asks for it.
  std::vector<bool> tell() {
    std::vector<bool> bases, finds, frictions;
    const auto cheaper = [](std::vector<bool>& said) {
      return [&said](int plain, int told) { return said.push_back(told < plain), said.back(); };
    };
    // What follows from other things of the image goes first, and comes back last.
    foretell_friction(false, cheaper(frictions));
    foretell_finds(cheaper(finds));
    for_each_base([&](auto& pose, const auto& from, const auto& foreseen) {
      bases.push_back(differing_bits(pose, foreseen) == 0);
      if (bases.back()) pose = from;
    });
    bases.insert(bases.end(), finds.begin(), finds.end());
    bases.insert(bases.end(), frictions.begin(), frictions.end());
    return bases;
  }
  /// `said()`: the next of those.
  template <class Said>
  void tell_back(Said&& said) {
    for_each_base([&](auto& pose, const auto&, const auto& foreseen) {
      if (said()) pose = foreseen;
    });
    foretell_finds([&](int, int) { return said(); });
    foretell_friction(true, [&](int, int) { return said(); });
  }

 private:
  /// Where the base is one step old, its poses tell to the bit how the shapes of most contacts stood to each other when
  /// that step looked at them. Calls f(Contact::base in the image, the base's, what it is foreseen to be).
  template <class F>
  void for_each_base(F&& f) {
    for_each_contact([&](std::size_t i, Contact c) {
      typename D::Pose pose[2];
      for (int side = 0; side < 2; ++side) {
        if (!body_pose(c.body[side], pose[side])) return;
        const typename D::Transform local = local_of(c.shape[side]);
        if (!(local == typename D::Transform{})) pose[side] = pose[side] * local;
      }
      f(c.base, old_of<Contact>(contacts(), i).base, typename D::Transform(relative(pose[0], pose[1])));
      put(contacts(), i, c);
    });
  }

  /// What update_convex finds for shapes that stand like that; it looked no farther ahead than that by velocities, so
  /// that it may have found less. `choose(plain, told)`: bits that what is kept of it differs by, from the base and
  /// from what is foreseen; returns whether it is told by the latter.
  template <class Choose>
  void foretell_finds(Choose&& choose) {
    for_each_contact([&](std::size_t i, Contact c) {
      const Contact old = old_of<Contact>(contacts(), i);
      const bool same = (old.flags & contact_in_use) != 0 && old.shape[0] == c.shape[0] && old.shape[1] == c.shape[1];
      const typename D::Shape *a = own_shape(c.shape[0]), *b = own_shape(c.shape[1]);
      if (a == nullptr || b == nullptr || (c.flags & (contact_sensor | contact_many)) != 0 || !is_sound(c) ||
          (same && c.base == old.base))
        return;
      geometry::PairCache cache = same ? old.cache : geometry::PairCache{};
      typename D::Manifold found;
      geometry::collide(*a, *b, c.base, 2 * c.margin() + 0.5f * c.inner, cache, found);
      if (c.first_manifold == none) {
        if (choose(differing_bits(c.cache, old.cache) + differing_bits(c.axis, old.axis),
                   differing_bits(c.cache, cache) + differing_bits(c.axis, found.normal))) {
          tell_by(c.cache, old.cache, cache);
          tell_by(c.axis, old.axis, found.normal);
        }
      } else if (std::size_t m = std::size_t(c.first_manifold);
                 m < data_.sections[manifolds()].count && found.count > 0) {
        Record record = at<Record>(manifolds(), m);
        const Record old_record = old_of<Record>(manifolds(), m);
        float gap = found.points[0].separation;
        for (int k = 1; k < found.count; ++k) gap = min(gap, found.points[k].separation);
        if (choose(
                differing_bits(c.cache, old.cache) + differing_bits(c.gap, old.gap) +
                    differing_bits(record.manifold, old_record.manifold),
                differing_bits(c.cache, cache) + differing_bits(c.gap, gap) + differing_bits(record.manifold, found))) {
          tell_by(c.cache, old.cache, cache);
          tell_by(c.gap, old.gap, gap);
          tell_by(record.manifold, old_record.manifold, found);
          put(manifolds(), m, record);
        }
      }
      put(contacts(), i, c);
    });
  }

  /// Friction that sticks anew does so in the middle of what is pressed, in both bodies at one place; and it acts
  /// across the normal. `choose` as above.
  template <class Choose>
  void foretell_friction(bool back, Choose&& choose) {
    for (std::size_t i = 0; i < data_.sections[manifolds()].count; ++i) {
      Record m = at<Record>(manifolds(), i);
      if (m.contact < 0 || std::size_t(m.contact) >= data_.sections[contacts()].count) continue;
      const Contact c = at<Contact>(contacts(), std::size_t(m.contact));
      typename D::Pose a, b;
      if ((c.flags & contact_in_use) == 0 || !is_shape(c.shape[0]) || !body_pose(c.body[0], a) ||
          !body_pose(c.body[1], b))
        continue;
      const Record old = old_of<Record>(manifolds(), i);
      const typename D::Transform local = local_of(c.shape[0]);
      const auto middle = [&] {
        return transform_point(local, pressed_middle(m, old)) - motion(c.body[0]).local_center;
      };
      const auto beside = [&] {
        const Vector apart(motion(c.body[0]).center - motion(c.body[1]).center);
        return inverse_rotate(b.rotation, rotate(a.rotation, m.anchor_a) + apart);
      };
      const Vector on_a = middle();
      if (choose(differing_bits(m.anchor_a, old.anchor_a) + differing_bits(m.anchor_b, old.anchor_b),
                 differing_bits(m.anchor_a, on_a) + differing_bits(m.anchor_b, beside()))) {
        if (back) tell_by(m.anchor_a, old.anchor_a, on_a);
        tell_by(m.anchor_b, old.anchor_b, beside());
        if (!back) tell_by(m.anchor_a, old.anchor_a, on_a);
      }
      tell_across(m.impulses.friction, old.impulses.friction, rotate(a.rotation, rotate(local.q, m.manifold.normal)));
      put(manifolds(), i, m);
    }
  }

  std::size_t contacts() const { return data_.manifolds_at - 1; }
  std::size_t manifolds() const { return data_.manifolds_at; }

  template <class T>
  T at(std::size_t section, std::size_t i) const {
    T value;
    std::memcpy(static_cast<void*>(&value),
                reinterpret_cast<const std::byte*>(image_.data() + data_.sections[section].first) + i * sizeof value,
                sizeof value);
    return value;
  }
  template <class T>
  void put(std::size_t section, std::size_t i, const T& value) {
    std::memcpy(section_values<std::byte>(image_, data_, section) + i * sizeof value, static_cast<const void*>(&value),
                sizeof value);
  }
  /// Of the base; zero where it has none, as what a difference begins with there.
  template <class T>
  T old_of(std::size_t section, std::size_t i) const {
    T value;
    const SnapshotSection& s = base_.sections[section];
    if (i < s.count)
      std::memcpy(static_cast<void*>(&value),
                  reinterpret_cast<const std::byte*>(base_image_.data() + s.first) + i * sizeof value, sizeof value);
    else
      std::memset(static_cast<void*>(&value), 0, sizeof value);
    return value;
  }
  bool is_shape(std::int32_t shape) const {
    return shape >= 0 && std::size_t(shape) < data_.sections[data_.shapes_at].count;
  }
  bool body_pose(std::int32_t body, typename D::Pose& pose) const {
    if (body < 0 || std::size_t(body) >= base_.sections[base_.bodies_at + 1].count) return false;
    pose = old_of<typename D::Pose>(base_.bodies_at + 1, std::size_t(body));
    return true;
  }
  BodyMotion<D> motion(std::int32_t body) const {
    return old_of<BodyMotion<D>>(base_.bodies_at + 2, std::size_t(body));
  }
  typename D::Transform local_of(std::int32_t shape) const {
    static_assert(std::is_base_of_v<ShapeTraits<D>, ShapeRecord<D>> && offsetof(ShapeTraits<D>, local) == 0);
    return at<ShapeTraits<D>>(data_.shapes_at, std::size_t(shape)).local;
  }
  /// The base's, unless many share it: whoever reads a difference may not have found those yet.
  const typename D::Shape* own_shape(std::int32_t shape) const {
    const auto i = std::size_t(shape);
    if (i >= base_.geometry->size() || (i < base_.missing.size() && base_.missing[i].shared != 0)) return nullptr;
    const typename D::Shape& s = (*base_.geometry)[i];
    return is_shared(s) ? nullptr : &s;
  }
  /// Within what geometry is made for.
  static bool is_sound(const Contact& c) {
    float turn[sizeof(c.base.q) / sizeof(float)], unit = 0;
    std::memcpy(turn, &c.base.q, sizeof turn);
    for (const float x : turn) unit += x * x;
    return math::length(c.base.p) < 1e6f && math::abs(unit - 1) < 1e-3f && c.inner > 0 && c.inner < 1e6f;
  }
  template <class F>
  void for_each_contact(F&& f) {
    for (std::size_t i = 0; i < data_.sections[contacts()].count; ++i) {
      const Contact c = at<Contact>(contacts(), i);
      if ((c.flags & contact_in_use) != 0 && is_shape(c.shape[0]) && is_shape(c.shape[1])) f(i, c);
    }
  }

  /// Middle of the points, by what they bore in the base; of all alike where they bore nothing.
  static Vector pressed_middle(const Record& m, const Record& old) {
    const int count = clamp(m.manifold.count, 0, D::max_points);
    float load = 0;
    for (int k = 0; k < count; ++k) load += old.impulses.normal[k];
    const bool pressed = old.contact == m.contact && load > 0;
    Vector sum{};
    float all = 0;
    for (int k = 0; k < count; ++k) {
      const float weight = pressed ? old.impulses.normal[k] : 1;
      sum += m.manifold.points[k].point * weight;
      all += weight;
    }
    return sum * (1 / max(all, 1e-30f));
  }
  /// What is perpendicular to n: its number along the greatest of n follows from the others, which stay as they are.
  /// Told so where any of them differs from before, and done again undone.
  static void tell_across(Vector& x, const Vector& from, const Vector& n) {
    int greatest = 0;
    for (int k = 1; k < D::dimension; ++k)
      if (math::abs(n[k]) > math::abs(n[greatest])) greatest = k;
    float sum = 0;
    bool differs = false;
    for (int k = 0; k < D::dimension; ++k)
      if (k != greatest) sum += x[k] * n[k], differs = differs || differing_bits(x[k], from[k]) != 0;
    if (differs && math::abs(n[greatest]) > 0.1f) tell_by(x[greatest], from[greatest], -sum / n[greatest]);
  }
  /// Bits that a difference takes, about.
  template <class T>
  static int differing_bits(T x, const T& y) {
    exclusive_or(x, y);
    std::uint32_t words[sizeof(T) / 4];
    std::memcpy(words, &x, sizeof x);
    int bits = 0;
    for (const std::uint32_t w : words)
      if (w != 0) bits += 34 - __builtin_clz(w);
    return bits;
  }

  std::vector<std::uint64_t>& image_;
  const SnapshotData<D>& data_;
  const SnapshotData<D>& base_;
  const std::vector<std::uint64_t>& base_image_;
};

}  // namespace carom::rigid::detail
