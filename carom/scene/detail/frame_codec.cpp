#include "carom/scene/detail/frame_codec.h"

#include "carom/math/vec.h"

namespace carom::scene::detail {
namespace {

/// Positions and the quaternion (w, x, y, z) as bits.
void to_bits(const RecordedBody& body, std::uint64_t (&bits)[7]) {
  for (int i = 0; i < 3; ++i) bits[i] = std::bit_cast<std::uint64_t>(body.position[i]);
  const float q[4] = {body.rotation.w, body.rotation.x, body.rotation.y, body.rotation.z};
  for (int i = 0; i < 4; ++i) bits[3 + i] = std::bit_cast<std::uint32_t>(q[i]);
}

void from_bits(const std::uint64_t (&bits)[7], RecordedBody& body) {
  for (int i = 0; i < 3; ++i) body.position[i] = std::bit_cast<double>(bits[i]);
  float q[4];
  for (int i = 0; i < 4; ++i) q[i] = std::bit_cast<float>(std::uint32_t(bits[3 + i]));
  body.rotation = {q[0], q[1], q[2], q[3]};
}

int byte_count(std::uint64_t value) { return (std::bit_width(value) + 7) / 8; }

constexpr std::uint8_t flag_hash = 1, flag_told = 2, flag_actions = 4, flag_picture = 8;
constexpr std::uint8_t body_asleep = 1, body_moved = 2;

}  // namespace

std::uint64_t FrameCodec::foretold(const Track& track, int component) const {
  if (component < 3) {
    const double now = std::bit_cast<double>(track.now[component]),
                 before = std::bit_cast<double>(track.before[component]);
    const double guess = now + (now - before);
    return math::is_finite(guess) ? std::bit_cast<std::uint64_t>(guess) : track.now[component];
  }
  const float now = std::bit_cast<float>(std::uint32_t(track.now[component]));
  const float before = std::bit_cast<float>(std::uint32_t(track.before[component]));
  const float guess = now + (now - before);
  return math::is_finite(guess) ? std::bit_cast<std::uint32_t>(guess) : track.now[component];
}

void FrameCodec::encode(const RecordedFrame& frame, bool key, ByteWriter& out) {
  out.varint(frame.step);
  out.number(frame.time);
  // What was told stays until it is told otherwise; a key frame stands alone.
  const bool told =
      key ? !frame.message.empty() || !frame.values.empty() : frame.message != message_ || frame.values != values_;
  const bool drawn = picture_.holds(frame.picture, key);
  out.fixed(std::uint8_t((frame.has_hash ? flag_hash : 0) | (told ? flag_told : 0) |
                         (frame.actions.empty() ? 0 : flag_actions) | (drawn ? flag_picture : 0)));
  if (frame.has_hash) out.fixed(frame.state_hash);
  out.varint(frame.samples.size());
  for (const RecordedSample& s : frame.samples) {
    out.fixed(s.plot);
    out.fixed(s.series);
    out.number(s.x);
    out.number(s.y);
  }

  next_.clear();
  std::size_t old = 0;
  std::vector<std::uint32_t> removed;
  ByteWriter changes;
  std::size_t changed = 0;
  std::uint32_t last_id = 0;
  const auto open_change = [&](std::uint32_t id, std::uint8_t flags) {
    changes.varint(id - last_id);
    changes.fixed(flags);
    last_id = id;
    ++changed;
  };
  for (const RecordedBody& body : frame.bodies) {
    while (!key && old < tracks_.size() && tracks_[old].id < body.id) removed.push_back(tracks_[old++].id);
    const bool known = !key && old < tracks_.size() && tracks_[old].id == body.id;
    Track track;
    track.id = body.id;
    track.asleep = body.asleep;
    to_bits(body, track.now);
    if (dimension_ == 2) track.now[2] = track.now[4] = track.now[5] = 0;
    if (known) {
      const Track& was = tracks_[old++];
      bool same = was.asleep == track.asleep;
      bool moved = false;
      for (int c = 0; c < 7; ++c) {
        track.before[c] = was.now[c];
        moved = moved || was.now[c] != track.now[c];
      }
      same = same && !moved;
      if (!same) {
        open_change(body.id, std::uint8_t((track.asleep ? body_asleep : 0) | (moved ? body_moved : 0)));
        if (moved) {
          std::uint64_t difference[7];
          int nibbles = 0, count = 0;
          std::uint32_t lengths = 0;
          for (int c = 0; c < 7; ++c) {
            if (!used(c)) continue;
            difference[count] = track.now[c] ^ foretold(was, c);
            lengths |= std::uint32_t(byte_count(difference[count])) << (4 * nibbles++);
            ++count;
          }
          if (dimension_ == 2)
            changes.fixed(std::uint16_t(lengths));
          else
            changes.fixed(lengths);
          for (int i = 0; i < count; ++i)
            for (int b = 0, n = byte_count(difference[i]); b < n; ++b)
              changes.fixed(std::uint8_t(difference[i] >> (8 * b)));
        }
      }
    } else {
      open_change(body.id, std::uint8_t((track.asleep ? body_asleep : 0) | body_moved));
      for (int c = 0; c < 7; ++c) {
        track.before[c] = track.now[c];
        if (!used(c)) continue;
        if (c < 3)
          changes.fixed(track.now[c]);
        else
          changes.fixed(std::uint32_t(track.now[c]));
      }
    }
    next_.push_back(track);
  }
  while (!key && old < tracks_.size()) removed.push_back(tracks_[old++].id);
  out.varint(removed.size());
  std::uint32_t last_removed = 0;
  for (const std::uint32_t id : removed) {
    out.varint(id - last_removed);
    last_removed = id;
  }
  out.varint(changed);
  out.bytes.insert(out.bytes.end(), changes.bytes.begin(), changes.bytes.end());
  tracks_.swap(next_);
  if (told || key) message_ = frame.message, values_ = frame.values;
  if (told) {
    out.text(message_);
    out.varint(values_.size());
    for (const double value : values_) out.number(value);
  }
  if (!frame.actions.empty()) {
    out.varint(frame.actions.size());
    for (const std::string& action : frame.actions) out.text(action);
  }
  if (drawn)
    picture_.encode(frame.picture, key, out);
  else
    picture_.clear();
}

bool FrameCodec::decode(std::span<const std::uint8_t> bytes, bool key, RecordedFrame& frame) {
  ByteReader in(bytes);
  frame.step = in.varint();
  frame.time = in.number();
  const std::uint8_t flags = in.fixed<std::uint8_t>();
  frame.has_hash = (flags & flag_hash) != 0;
  frame.state_hash = frame.has_hash ? in.fixed<std::uint64_t>() : 0;
  frame.samples.resize(in.count(20));
  for (RecordedSample& s : frame.samples) {
    s.plot = in.fixed<std::uint16_t>();
    s.series = in.fixed<std::uint16_t>();
    s.x = in.number();
    s.y = in.number();
  }
  if (!decode_bodies(in, key, frame)) return false;
  if (key) message_.clear(), values_.clear();
  if (flags & flag_told) {
    message_ = in.text();
    values_.resize(in.count(8));
    for (double& value : values_) value = in.number();
  }
  frame.message = message_;
  frame.values = values_;
  frame.actions.resize(flags & flag_actions ? in.count(1) : 0);
  for (std::string& action : frame.actions) action = in.text();
  if (flags & flag_picture) {
    if (!picture_.decode(in, key, frame.picture)) return false;
  } else {
    picture_.clear();
    frame.picture = {};
  }
  return in.good() && in.left() == 0 && math::is_finite(frame.time);
}

bool FrameCodec::decode_bodies(ByteReader& in, bool key, RecordedFrame& frame) {
  if (key) tracks_.clear();
  // Removed ids rise, as all ids here do.
  const std::size_t removed = in.count(1);
  std::uint64_t id = 0;
  std::size_t old = 0;
  next_.clear();
  for (std::size_t i = 0; i < removed && in.good(); ++i) {
    id += in.varint();
    while (old < tracks_.size() && tracks_[old].id < id) next_.push_back(tracks_[old++]);
    if (old == tracks_.size() || tracks_[old].id != id)
      in.spoil();
    else
      ++old;
  }
  while (old < tracks_.size()) next_.push_back(tracks_[old++]);
  tracks_.swap(next_);

  next_.clear();
  const std::size_t changed = in.count(2);
  id = 0;
  old = 0;
  const auto keep = [this](Track track) {
    for (int c = 0; c < 7; ++c) track.before[c] = track.now[c];
    next_.push_back(track);
  };
  for (std::size_t i = 0; i < changed && in.good(); ++i) {
    const std::uint64_t step = in.varint();
    if (i > 0 && step == 0) in.spoil();
    id += step;
    if (step > 0xFFFFFFFFu || id > 0xFFFFFFFFu) in.spoil();
    if (!in.good()) break;
    while (old < tracks_.size() && tracks_[old].id < id) keep(tracks_[old++]);
    const bool known = old < tracks_.size() && tracks_[old].id == id;
    const std::uint8_t marks = in.fixed<std::uint8_t>();
    Track track;
    track.id = std::uint32_t(id);
    track.asleep = (marks & body_asleep) != 0;
    if (known) {
      const Track& was = tracks_[old++];
      const bool moved = (marks & body_moved) != 0;
      const std::uint32_t lengths = !moved            ? 0
                                    : dimension_ == 2 ? in.fixed<std::uint16_t>()
                                                      : in.fixed<std::uint32_t>();
      int nibble = 0;
      for (int c = 0; c < 7; ++c) {
        track.before[c] = was.now[c];
        track.now[c] = was.now[c];
        if (!moved || !used(c)) continue;
        const int length = int(lengths >> (4 * nibble++) & 15u);
        if (length > (c < 3 ? 8 : 4)) in.spoil();
        std::uint64_t difference = 0;
        for (int b = 0; b < length && in.good(); ++b) difference |= std::uint64_t(in.fixed<std::uint8_t>()) << (8 * b);
        track.now[c] = foretold(was, c) ^ difference;
      }
    } else {
      for (int c = 0; c < 7; ++c) {
        if (!used(c)) continue;
        track.now[c] = c < 3 ? in.fixed<std::uint64_t>() : in.fixed<std::uint32_t>();
        track.before[c] = track.now[c];
      }
    }
    next_.push_back(track);
  }
  while (old < tracks_.size()) keep(tracks_[old++]);
  tracks_.swap(next_);
  if (!in.good()) return false;
  frame.bodies.resize(tracks_.size());
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    frame.bodies[i].id = tracks_[i].id;
    frame.bodies[i].asleep = tracks_[i].asleep;
    from_bits(tracks_[i].now, frame.bodies[i]);
    if (!math::is_finite(frame.bodies[i].position) || !math::is_finite(frame.bodies[i].rotation)) return false;
  }
  return true;
}

}  // namespace carom::scene::detail
