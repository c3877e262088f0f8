#include "carom/rigid/snapshot.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "carom/core/hash.h"
#include "carom/core/string.h"
#include "carom/rigid/detail/snapshot_code.h"
#include "carom/rigid/detail/snapshot_contacts.h"

namespace carom::rigid {
namespace detail {
namespace {

constexpr std::uint64_t magic = 0x31504E534D524143u;  // "CARMSNP1"
constexpr std::uint64_t format_version = 13;
constexpr std::uint64_t most_words = std::uint64_t{1} << 32, most_sections = 4096;

/// Where compilers and machines could lay out the plain bytes of a state differently.
template <class D>
std::uint64_t layout() {
  core::StateHash hash;
  hash.add(format_version).add(std::int32_t(D::dimension));
  const std::size_t sizes[] = {
      sizeof(SolverBody<D>), sizeof(typename D::Pose), sizeof(BodyMotion<D>),    sizeof(BodyRecord),
      sizeof(ShapeExtra<D>), sizeof(PartSurface<D>),   sizeof(ShapeTraits<D>),   sizeof(JointHeader),
      sizeof(SmallJoint<D>), sizeof(EffectorDef<D>),   sizeof(ContactRecord<D>), sizeof(ManifoldRecord<D>),
      sizeof(WorldDef<D>),   sizeof(LargeJoint<D>),    sizeof(std::size_t),      sizeof(ShapeTerms)};
  for (const std::size_t size : sizes) hash.add(std::uint64_t{size});
  hash.add(std::endian::native == std::endian::little);
#if defined(_LIBCPP_VERSION)
  hash.add("libc++");  // lays out variants in its own way
#elif defined(__GLIBCXX__)
  hash.add("libstdc++");
#endif
  return hash.digest();
}

template <class D>
std::uint64_t digest_of(const SnapshotData<D>* data) {
  return data == nullptr ? 0 : hash_words(canonical_image(*data));
}
std::uint64_t checksum(std::span<const std::byte> bytes) {
  std::vector<std::uint64_t> words((bytes.size() + 7) / 8);
  if (!bytes.empty()) std::memcpy(words.data(), bytes.data(), bytes.size());
  words.push_back(bytes.size());
  return hash_words(words);
}

const std::uint32_t* words_of(const SnapshotSection& s, const std::vector<std::uint64_t>& image) {
  return reinterpret_cast<const std::uint32_t*>(image.data() + s.first);
}
/// Do the bodies of a slot differ in what is folded (pose, motion and record)?
template <class D>
bool body_differs(const SnapshotData<D>& a, const std::vector<std::uint64_t>& image_a, const SnapshotData<D>& b,
                  const std::vector<std::uint64_t>& image_b, std::size_t slot) {
  for (std::size_t k = 1; k < 4; ++k) {
    const SnapshotSection &sa = a.sections[a.bodies_at + k], &sb = b.sections[b.bodies_at + k];
    const std::size_t words = sa.element / 8;
    if (std::memcmp(&image_a[sa.first + slot * words], &image_b[sb.first + slot * words], words * 8) != 0) return true;
  }
  return false;
}
/// Codes the attitudes and centres of the bodies of `folded` as they differ from what is foreseen, in words that are
/// exclusive-or'ed with the base's. `by_way`: whose centre is told by its way.
template <class D>
void foretell_bodies(std::vector<std::uint64_t>& image, const SnapshotData<D>& data, const SnapshotData<D>& base,
                     std::vector<std::uint64_t>& base_image, const std::vector<bool>& folded, std::size_t common,
                     std::vector<bool>& by_way, bool back) {
  const BodyForesight<D> foresight(image, data, base, base_image);
  auto* const pose = section_values<typename D::Pose>(image, data, data.bodies_at + 1);
  auto* const motion = section_values<BodyMotion<D>>(image, data, data.bodies_at + 2);
  auto* const base_pose = section_values<typename D::Pose>(base_image, base, base.bodies_at + 1);
  auto* const base_motion = section_values<BodyMotion<D>>(base_image, base, base.bodies_at + 2);
  for (std::size_t i = 0; i < common; ++i) {
    if (!folded[i]) continue;
    const typename D::Rotation& from = base_pose[i].rotation;
    tell_rotation(pose[i].rotation, from, foresight.rotation(i, from), back);
    if (!back)
      by_way[i] = tell_center_by_way(motion[i].center, base_motion[i].center, foresight.way(i));
    else if (by_way[i])
      center_by_way(motion[i].center, base_motion[i].center, foresight.way(i));
  }
}
std::size_t word_count(const SnapshotSection& s) { return std::size_t((s.count * s.element + 7) / 8); }

template <class D>
std::vector<GeometryRecord> geometry_records(const SnapshotData<D>& data) {
  std::vector<GeometryRecord> records;
  for (const typename D::Shape& shape : *data.geometry) records.push_back(geometry_record(shape));
  return records;
}
/// What is not yet found in a world keeps its record.
template <class D>
std::vector<GeometryRecord> known_records(const SnapshotData<D>* data) {
  if (data == nullptr) return {};
  std::vector<GeometryRecord> records = geometry_records(*data);
  for (std::size_t i = 0; i < data->missing.size(); ++i)
    if (data->missing[i].shared != 0) records[i] = data->missing[i];
  return records;
}

/// The only effector with numbers of its own elsewhere.
template <class D>
void write_drag(ByteWriter& out, const BodyDrag<D>& e) {
  out.word(e.body.packed());
  out.number(std::uint32_t(e.law.kind));
  for (const double x : {e.law.coefficient, e.diameter, e.area, e.density, e.viscosity, e.speed_of_sound})
    out.word(std::bit_cast<std::uint64_t>(x));
  for (int k = 0; k < D::dimension; ++k) out.word(std::bit_cast<std::uint32_t>(e.point[k]));
  out.number(e.law.table.logarithmic());
  out.number(e.law.table.points().size());
  for (const forces::CoefficientPoint& p : e.law.table.points())
    for (const double x : {p.x, p.y}) out.word(std::bit_cast<std::uint64_t>(x));
}
inline BodyId body_of(std::uint64_t packed) {
  return {std::uint32_t(packed >> 32), std::uint16_t(packed >> 16), std::uint16_t(packed)};
}
template <class D>
void read_drag(ByteReader& in, BodyDrag<D>& e) {
  e.body = body_of(in.word());
  e.law.kind = forces::DragLaw::Kind(std::int32_t(std::uint32_t(in.number())));
  for (double* const x : {&e.law.coefficient, &e.diameter, &e.area, &e.density, &e.viscosity, &e.speed_of_sound})
    *x = std::bit_cast<double>(in.word());
  for (int k = 0; k < D::dimension; ++k) e.point[k] = std::bit_cast<float>(std::uint32_t(in.word()));
  const bool logarithmic = in.number() != 0;
  const std::uint64_t count = in.number();
  if (count > forces::CoefficientTable::capacity) return in.fail();
  if (count == 0 && !logarithmic) return;
  std::vector<forces::CoefficientPoint> points(std::size_t(count), forces::CoefficientPoint{});
  for (forces::CoefficientPoint& p : points)
    for (double* const x : {&p.x, &p.y}) *x = std::bit_cast<double>(in.word());
  e.law.table = forces::CoefficientTable(std::move(points), logarithmic);
}

template <class D>
void write_effectors(ByteWriter& out, const std::vector<EffectorData<D>>& effectors) {
  out.number(effectors.size());
  for (const EffectorData<D>& e : effectors) {
    out.number(e.definition.index());
    out.number(std::uint32_t(e.joint));
    std::visit(
        [&]<class T>(const T& value) {
          if constexpr (std::is_trivially_copyable_v<T>) {
            std::vector<std::uint32_t> words((sizeof(T) + 3) / 4);
            std::memcpy(words.data(), &value, sizeof(T));
            SectionModel model(words.size());
            out.difference(words.data(), nullptr, words.size(), model);
          } else if constexpr (std::is_same_v<T, BodyDrag<D>>) {
            write_drag<D>(out, value);
          } else if constexpr (requires { value.body; }) {
            out.word(value.body.packed());  // a function of the caller: only whom it pushes
          }
        },
        e.definition);
  }
}

template <class Variant, std::size_t I = 0>
bool read_effector(ByteReader& in, std::size_t index, Variant& definition) {
  if constexpr (I == std::variant_size_v<Variant>) {
    return false;
  } else {
    if (index != I) return read_effector<Variant, I + 1>(in, index, definition);
    using T = std::variant_alternative_t<I, Variant>;
    T value{};
    if constexpr (std::is_trivially_copyable_v<T>) {
      std::vector<std::uint32_t> words((sizeof(T) + 3) / 4);
      SectionModel model(words.size());
      in.difference(words.data(), words.size(), model);
      std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
    } else if constexpr (requires { value.law.table; }) {
      read_drag(in, value);
    } else if constexpr (requires { value.body; }) {
      value.body = body_of(in.word());
    }
    definition = value;
    return in.sound();
  }
}

void append_word(std::vector<std::byte>& out, std::uint64_t x) {
  for (int i = 0; i < 8; ++i) out.push_back(std::byte(std::uint8_t(x >> (8 * i))));
}
std::uint64_t word_at(std::span<const std::byte> bytes, std::size_t at) {
  std::uint64_t x = 0;
  for (std::size_t i = 0; i < 8; ++i) x |= std::uint64_t{std::uint8_t(bytes[at + i])} << (8 * i);
  return x;
}

template <class D>
std::vector<std::byte> encode_difference(const SnapshotData<D>& data, const SnapshotData<D>* base) {
  std::vector<std::byte> bytes;
  std::vector<std::uint64_t> image = canonical_image(data), base_image;
  if (base != nullptr) base_image = canonical_image(*base);
  for (const std::uint64_t x :
       {magic, layout<D>(), base != nullptr ? hash_words(base_image) : std::uint64_t{0}, hash_words(image)})
    append_word(bytes, x);
  ByteWriter out(bytes);
  const std::size_t bodies = std::size_t(data.sections[data.bodies_at].count);
  const std::size_t common_bodies =
      base != nullptr ? std::min(bodies, std::size_t(base->sections[base->bodies_at].count)) : 0;
  std::vector<bool> foretold;
  if (base != nullptr) foretold = ContactForesight<D>(image, data, *base, base_image).tell();
  std::vector<bool> folded(bodies, true);
  for (std::size_t i = 0; i < common_bodies; ++i) folded[i] = body_differs(data, image, *base, base_image, i);
  fold_bodies(image, data, [&](std::size_t i) { return folded[i]; });
  if (base != nullptr) fold_bodies(base_image, *base, [&](std::size_t i) { return i < common_bodies && folded[i]; });
  std::vector<bool> by_way(common_bodies);
  if (base != nullptr) foretell_bodies(image, data, *base, base_image, folded, common_bodies, by_way, false);
  fold_trees(image, data, false);
  if (base != nullptr) fold_trees(base_image, *base, false);
  out.number(data.world_number);
  out.number(data.step_count);
  out.number(data.sections.size());
  out.number(data.bodies_at);
  out.number(data.shapes_at);
  out.number(data.manifolds_at);
  out.number(data.trees_at);
  out.number(data.pairs_at);
  for (std::size_t i = 0; i < data.sections.size(); ++i) {
    const SnapshotSection& s = data.sections[i];
    const SnapshotSection b = base != nullptr ? base->sections[i] : SnapshotSection{};
    out.number(s.count);
    if (base == nullptr) out.number(s.element);
    const std::size_t count = word_count(s), common = std::min(count, base != nullptr ? word_count(b) : 0);
    SectionModel model(std::size_t(s.element) / 4);
    out.difference(words_of(s, image), words_of(b, base_image), 2 * common, model);
    out.difference(words_of(s, image) + 2 * common, nullptr, 2 * (count - common), model);
  }
  BitModel differs, foresight;
  for (std::size_t i = 0; i < common_bodies; ++i) {
    out.bit(differs, folded[i]);
    if (folded[i]) out.bit(foresight, by_way[i]);
  }
  foresight = {};
  for (const bool x : foretold) out.bit(foresight, x);
  // Geometry by slot, where it is not as in the base.
  SectionModel geometry_model(std::size(GeometryRecord{}.value));
  const bool same = base != nullptr && base->geometry == data.geometry && base->missing.empty();
  const std::vector<GeometryRecord> now = same ? std::vector<GeometryRecord>{} : known_records(&data);
  const std::vector<GeometryRecord> before = same ? std::vector<GeometryRecord>{} : known_records(base);
  out.number(data.geometry->size());
  out.byte(same ? 0 : 1);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const bool equal = i < before.size() && before[i] == now[i];
    // A changed terrain is sent itself, unless this one came as bytes and was not yet looked up.
    const bool sent = now[i].shared == 2 && (i >= data.missing.size() || data.missing[i].shared == 0);
    out.byte(equal ? 0 : (sent ? 3 : (now[i].shared != 0 ? 2 : 1)));
    if (equal) continue;
    out.number(now[i].type);
    if (sent)
      write_terrain(out, (*data.geometry)[i], i < before.size() ? &(*base->geometry)[i] : nullptr);
    else if (now[i].shared != 0)
      out.word(now[i].fingerprint);
    else
      out.difference(now[i].value, nullptr, std::size(now[i].value), geometry_model);
  }
  write_effectors<D>(out, data.effectors);
  out.finish();
  append_word(bytes, checksum(bytes));
  return bytes;
}

template <class D>
bool read_sections(ByteReader& in, SnapshotData<D>& data, const SnapshotData<D>* base) {
  const std::uint64_t sections = in.number();
  if (sections > most_sections || (base != nullptr && sections != base->sections.size())) return false;
  data.bodies_at = std::size_t(in.number());
  data.shapes_at = std::size_t(in.number());
  data.manifolds_at = std::size_t(in.number());
  data.trees_at = std::size_t(in.number());
  data.pairs_at = std::size_t(in.number());
  std::uint64_t more = 0;  // words than the base has
  // The differences first: zero where the base holds.
  for (std::uint64_t i = 0; i < sections && in.sound(); ++i) {
    SnapshotSection s;
    s.count = in.number();
    s.element = base != nullptr ? base->sections[i].element : in.number();
    s.first = data.image.size();
    if (s.count > most_words || s.element == 0 || s.element > 65536 || s.count * s.element > most_words) return false;
    const std::size_t count = word_count(s);
    const std::size_t common = std::min(count, base != nullptr ? word_count(base->sections[i]) : 0);
    more += count - common;
    if (!in.plausible(more)) return false;
    data.image.resize(data.image.size() + count);
    std::uint32_t* const words = reinterpret_cast<std::uint32_t*>(data.image.data() + s.first);
    SectionModel model(std::size_t(s.element) / 4);
    in.difference(words, 2 * common, model);
    in.difference(words + 2 * common, 2 * (count - common), model);
    data.sections.push_back(s);
  }
  const auto is = [&](std::size_t at, std::size_t element) {
    return at < data.sections.size() && data.sections[at].element == element;
  };
  if (!in.sound() || data.bodies_at > sections || !is(data.bodies_at + 1, sizeof(typename D::Pose)) ||
      !is(data.bodies_at + 2, sizeof(BodyMotion<D>)) || !is(data.bodies_at + 3, sizeof(BodyRecord)) ||
      !is(data.shapes_at, sizeof(ShapeTraits<D>)) || data.manifolds_at < 1 ||
      !is(data.manifolds_at - 1, sizeof(ContactRecord<D>)) || !is(data.manifolds_at, sizeof(ManifoldRecord<D>)) ||
      !is(data.pairs_at, sizeof(std::uint64_t)) || data.trees_at > sections)
    return false;
  for (std::size_t tree = 0; tree < 3; ++tree) {
    const std::size_t at = data.trees_at + 5 * tree;
    if (!is(at, sizeof(TreeNodeImage<D>)) || !is(at + 1, sizeof(std::int32_t)) || data.sections[at + 1].count != 1)
      return false;
  }
  const SnapshotSection& time = data.sections[data.sections.size() - 2];
  if (time.element != sizeof(double) || time.count != 1) return false;
  if (base != nullptr &&
      (base->bodies_at != data.bodies_at || base->manifolds_at != data.manifolds_at ||
       base->shapes_at != data.shapes_at || base->trees_at != data.trees_at || base->pairs_at != data.pairs_at))
    return false;
  const std::size_t bodies = std::size_t(data.sections[data.bodies_at].count);
  for (std::size_t k = 1; k < 4; ++k)
    if (data.sections[data.bodies_at + k].count != bodies) return false;
  std::vector<bool> folded(bodies, true);
  if (base == nullptr) {
    fold_trees(data.image, data, true);
    fold_bodies(data.image, data, [&](std::size_t i) { return folded[i]; });
    return true;
  }
  const std::size_t common_bodies = std::min(bodies, std::size_t(base->sections[base->bodies_at].count));
  std::vector<bool> by_way(common_bodies);
  BitModel differs, foresight;
  for (std::size_t i = 0; i < common_bodies; ++i) {
    folded[i] = in.bit(differs);
    if (folded[i]) by_way[i] = in.bit(foresight);
  }
  const std::vector<std::uint64_t> plain_base = canonical_image(*base);
  std::vector<std::uint64_t> base_image = plain_base;
  fold_bodies(base_image, *base, [&](std::size_t i) { return i < common_bodies && folded[i]; });
  fold_trees(base_image, *base, false);
  for (std::uint64_t i = 0; i < sections; ++i) {
    const SnapshotSection &s = data.sections[i], &b = base->sections[i];
    const std::size_t common = std::min(word_count(s), word_count(b));
    for (std::size_t w = 0; w < common; ++w) data.image[s.first + w] ^= base_image[b.first + w];
  }
  fold_trees(data.image, data, true);
  foretell_bodies(data.image, data, *base, base_image, folded, common_bodies, by_way, true);
  fold_bodies(data.image, data, [&](std::size_t i) { return folded[i]; });
  BitModel foretold;
  ContactForesight<D>(data.image, data, *base, plain_base).tell_back([&] { return in.bit(foretold); });
  return in.sound();
}

template <class D>
bool read_geometry(ByteReader& in, SnapshotData<D>& data, const SnapshotData<D>* base) {
  const std::uint64_t count = in.number();
  const bool changed = in.byte() != 0;
  if (!changed) {
    if (base == nullptr || base->geometry->size() != count) return false;
    data.geometry = base->geometry;
    data.missing = base->missing;
    return in.sound();
  }
  if (count > in.left() + 8) return false;  // a byte a slot at least
  auto shapes = std::make_shared<std::vector<typename D::Shape>>(std::size_t(count));
  data.missing.resize(std::size_t(count));
  bool any = false;
  SectionModel geometry_model(std::size(GeometryRecord{}.value));
  for (std::size_t i = 0; i < count && in.sound(); ++i) {
    GeometryRecord record;
    switch (in.byte()) {
      case 0:
        if (base == nullptr || i >= base->geometry->size()) return false;
        (*shapes)[i] = (*base->geometry)[i];
        if (i < base->missing.size()) data.missing[i] = base->missing[i];
        break;
      case 1:
        record.type = std::uint32_t(in.number());
        in.difference(record.value, std::size(record.value), geometry_model);
        if (!shape_of(record, (*shapes)[i])) return false;
        break;
      case 2:
        record.type = std::uint32_t(in.number());
        record.shared = 1;
        record.fingerprint = in.word();
        data.missing[i] = record;
        break;
      case 3:
        record.type = std::uint32_t(in.number());
        if (!read_terrain(in, record.type,
                          base != nullptr && i < base->geometry->size() ? &(*base->geometry)[i] : nullptr,
                          (*shapes)[i]))
          return false;
        break;
      default:
        return false;
    }
    any = any || data.missing[i].shared != 0;
  }
  if (!any) data.missing.clear();
  data.geometry = std::move(shapes);
  return in.sound();
}

template <class D>
bool read_effectors(ByteReader& in, SnapshotData<D>& data) {
  const std::uint64_t count = in.number();
  if (count > in.left() + 8) return false;
  data.effectors.resize(std::size_t(count));
  for (EffectorData<D>& e : data.effectors) {
    const std::uint64_t index = in.number();
    e.joint = std::int32_t(std::uint32_t(in.number()));
    if (!read_effector(in, std::size_t(index), e.definition)) return false;
  }
  return in.sound();
}

}  // namespace
}  // namespace detail

template <class D>
Snapshot<D>::Snapshot() = default;
template <class D>
Snapshot<D>::~Snapshot() = default;
template <class D>
Snapshot<D>::Snapshot(Snapshot&&) noexcept = default;
template <class D>
Snapshot<D>& Snapshot<D>::operator=(Snapshot&&) noexcept = default;
template <class D>
Snapshot<D>::Snapshot(const Snapshot& other) {
  *this = other;
}
template <class D>
Snapshot<D>& Snapshot<D>::operator=(const Snapshot& other) {
  if (this == &other) return *this;
  if (other.self_ == nullptr)
    self_.reset();
  else if (self_ == nullptr)
    self_ = std::make_unique<detail::SnapshotData<D>>(*other.self_);
  else
    *self_ = *other.self_;
  return *this;
}

template <class D>
bool Snapshot<D>::empty() const {
  return self_ == nullptr;
}
template <class D>
std::uint64_t Snapshot<D>::step_count() const {
  return empty() ? 0 : self_->step_count;
}
template <class D>
std::size_t Snapshot<D>::bytes() const {
  return empty() ? 0
                 : sizeof(*self_) + self_->image.capacity() * 8 +
                       self_->sections.capacity() * sizeof(detail::SnapshotSection) +
                       self_->effectors.capacity() * sizeof(detail::EffectorData<D>);
}
template <class D>
std::uint64_t Snapshot<D>::digest() const {
  return detail::digest_of<D>(self_.get());
}

template <class D>
std::vector<std::byte> Snapshot<D>::encode() const {
  return empty() ? std::vector<std::byte>{} : detail::encode_difference<D>(*self_, nullptr);
}
template <class D>
std::vector<std::byte> Snapshot<D>::encode(const Snapshot& base) const {
  return empty() ? std::vector<std::byte>{} : detail::encode_difference<D>(*self_, base.self_.get());
}

template <class D>
core::Result<Snapshot<D>> Snapshot<D>::decode(std::span<const std::byte> bytes, const Snapshot& base) {
  using namespace detail;
  const auto fault = [](std::string_view what) { return core::Error{core::text("Snapshot::decode: ", what)}; };
  if (bytes.size() < 48)
    return fault(core::text("the data is ", bytes.size(), " bytes, expected a snapshot, which has at least 48"));
  if (word_at(bytes, 0) != magic) return fault("the data does not begin as a snapshot of this version does");
  if (word_at(bytes, 8) != layout<D>())
    return fault("the snapshot was made by another version, for another dimension or on a machine with another layout");
  if (word_at(bytes, bytes.size() - 8) != checksum(bytes.first(bytes.size() - 8)))
    return fault("the checksum does not match, expected whole data: it is truncated or corrupt");
  const std::uint64_t base_digest = word_at(bytes, 16), digest = word_at(bytes, 24);
  ByteReader in(bytes.subspan(32, bytes.size() - 40));
  if (base_digest != digest_of<D>(base.self_.get()))
    return fault(base_digest == 0 ? "the data is a whole snapshot, expected a difference to the given base"
                                  : "the data is a difference to another base than the one given");
  Snapshot result;
  result.self_ = std::make_unique<SnapshotData<D>>();
  SnapshotData<D>& data = *result.self_;
  data.decoded = true;
  data.world_number = std::uint16_t(in.number());
  data.step_count = in.number();
  if (!read_sections<D>(in, data, base.self_.get()) || !read_geometry<D>(in, data, base.self_.get()) ||
      !read_effectors<D>(in, data) || !in.at_end())
    return fault("the data is not what a snapshot holds");
  if (hash_words(data.image) != digest) return fault("the state does not match its digest, expected whole data");
  if (!write_pairs(data)) return fault("the contacts do not make a set of pairs of the size that is told");
  return result;
}

template class Snapshot<Dim2>;
template class Snapshot<Dim3>;

}  // namespace carom::rigid
