// A page for tests: takes the host's messages apart as docs/protocol.md says, and fails where one does not fit.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/host/host.h"
#include "apps/host/registry.h"

namespace carom::host::test {

using Json = nlohmann::json;

struct Frame {
  bool key = false, has_stats = false;
  int dimension = 0;
  std::uint32_t sequence = 0, step = 0;
  double time = 0;
  struct Body {
    std::uint32_t id = 0;
    bool asleep = false;
    math::Vec3d position{};
    double rotation[4] = {};
  };
  std::vector<Body> bodies;
  std::vector<Sample> samples;
  std::size_t lines = 0;
  std::uint32_t stat_bodies = 0, stat_awake = 0, stat_threads = 0;
  double kinetic = 0, potential = 0;
  std::uint64_t hash = 0;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}
  template <class T>
  T get() {
    T value{};
    if (at_ + sizeof value > bytes_.size()) {
      ADD_FAILURE() << "binary message ends at " << bytes_.size();
      return value;
    }
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

/// Points and surfaces: what the messages say of their own length must be so.
inline std::size_t decode_points(const std::string& bytes) {
  Reader in(bytes);
  EXPECT_EQ(in.get<std::uint32_t>(), 4u);
  const std::size_t count = in.get<std::uint32_t>();
  for (int k = 0; k < 6; ++k) EXPECT_TRUE(math::is_finite(in.get<float>()));
  EXPECT_GE(in.get<float>(), 0);
  EXPECT_EQ(bytes.size(), 36 + 12 * count);
  return count;
}
inline std::size_t decode_surface(const std::string& bytes) {
  Reader in(bytes);
  EXPECT_EQ(in.get<std::uint8_t>(), 5);
  const bool with_triangles = in.get<std::uint8_t>() & 1;
  in.get<std::uint16_t>(), in.get<std::uint32_t>();
  const std::size_t corners = in.get<std::uint32_t>(), indices = in.get<std::uint32_t>();
  in.get<std::uint32_t>();
  for (std::size_t i = 0; i < 3 * corners; ++i) EXPECT_TRUE(math::is_finite(in.get<float>()));
  EXPECT_EQ(indices > 0, with_triangles);
  for (std::size_t i = 0; i < indices; ++i) EXPECT_LT(in.get<std::uint32_t>(), corners);
  EXPECT_TRUE(in.at_end());
  return indices / 3;
}

inline Frame decode_frame(const std::string& bytes) {
  Frame f;
  Reader in(bytes);
  EXPECT_EQ(in.get<std::uint8_t>(), 2);
  const auto flags = in.get<std::uint8_t>();
  f.key = flags & 1;
  f.has_stats = flags & 2;
  f.dimension = in.get<std::uint16_t>();
  f.sequence = in.get<std::uint32_t>();
  f.step = in.get<std::uint32_t>();
  const auto bodies = in.get<std::uint32_t>(), samples = in.get<std::uint32_t>(), lines = in.get<std::uint32_t>();
  f.time = in.get<double>();
  const double x = in.get<double>(), y = in.get<double>(), z = in.get<double>();
  for (std::uint32_t i = 0; i < bodies; ++i) {
    Frame::Body b;
    const auto id = in.get<std::uint32_t>();
    b.id = id & 0x7fffffff;
    b.asleep = id >> 31;
    b.position.x = x + in.get<float>();
    b.position.y = y + in.get<float>();
    b.position.z = z + in.get<float>();
    for (double& q : b.rotation) q = in.get<std::int16_t>() / 32767.0;
    f.bodies.push_back(b);
  }
  for (std::uint32_t i = 0; i < samples; ++i) {
    Sample s;
    s.plot = in.get<std::uint16_t>();
    s.series = in.get<std::uint16_t>();
    s.x = in.get<double>();
    s.y = in.get<double>();
    f.samples.push_back(s);
  }
  for (std::uint32_t i = 0; i < lines; ++i)
    for (int k = 0; k < 7; ++k) in.get<std::uint32_t>();
  f.lines = lines;
  if (f.has_stats) {
    f.stat_bodies = in.get<std::uint32_t>();
    f.stat_awake = in.get<std::uint32_t>();
    for (int i = 0; i < 3; ++i) in.get<std::uint32_t>();
    f.stat_threads = in.get<std::uint32_t>();
    in.get<float>();
    in.get<float>();
    f.kinetic = in.get<double>();
    f.potential = in.get<double>();
    f.hash = in.get<std::uint64_t>();
    in.get<double>();
  }
  EXPECT_TRUE(in.at_end());
  return f;
}

/// Drives a host and keeps what it said.
class Page {
 public:
  explicit Page(HostOptions options = {}) : host(std::move(options)) {}

  void send(const Json& message) { raw(message.dump()); }
  void raw(const std::string& text) {
    host.receive(text);
    drain();
  }
  void advance(double seconds = 1.0 / 60) {
    host.advance(seconds);
    drain();
  }
  void hello() { send({{"type", "hello"}, {"protocol", 1}}); }
  void open(const std::string& demo, Json parameters = Json::object()) {
    hello();
    send({{"type", "open"}, {"demo", demo}, {"parameters", parameters}});
  }
  void ack() {
    if (!frames.empty()) send({{"type", "ack"}, {"sequence", frames.back().sequence}});
  }
  /// Runs for so long, acknowledging every frame.
  void run_for(double seconds) {
    for (int i = 0; i < int(seconds * 60 + 0.5); ++i) {
      advance();
      ack();
    }
  }
  Json last(const std::string& type) const {
    for (std::size_t i = texts.size(); i-- > 0;)
      if (texts[i].value("type", std::string()) == type) return texts[i];
    return nullptr;
  }
  int count(const std::string& type) const {
    int n = 0;
    for (const Json& t : texts) n += t["type"] == type;
    return n;
  }
  Frame::Body body(std::uint32_t id) const {
    const auto found = bodies.find(id);
    EXPECT_NE(found, bodies.end()) << "no body " << id;
    return found == bodies.end() ? Frame::Body{} : found->second;
  }

  SimulationHost host;
  std::vector<Json> texts;
  std::vector<Frame> frames;
  std::map<std::uint32_t, Frame::Body> bodies;  ///< as the frames left them
  std::size_t meshes = 0;
  std::size_t points = 0;          ///< shown now
  std::size_t triangles = 0;       ///< of surfaces, that came so far
  std::vector<std::string> files;  ///< recordings that the host made

 private:
  void drain() {
    Message message;
    while (host.take(message)) {
      if (message.text) {
        const Json json = Json::parse(message.data, nullptr, false);
        ASSERT_TRUE(json.is_object()) << message.data;
        texts.push_back(json);
        continue;
      }
      ASSERT_FALSE(message.data.empty());
      if (message.data[0] == 1) {
        ++meshes;
        continue;
      }
      if (message.data[0] == file_message_kind) {
        files.push_back(message.data.substr(4));
        continue;
      }
      if (message.data[0] == 4) {
        points = decode_points(message.data);
        continue;
      }
      if (message.data[0] == 5) {
        triangles += decode_surface(message.data);
        continue;
      }
      frames.push_back(decode_frame(message.data));
      if (frames.back().key) bodies.clear();
      for (const Frame::Body& b : frames.back().bodies) bodies[b.id] = b;
    }
  }
};

inline std::vector<std::string> demo_ids() {
  std::vector<std::string> out;
  for (const DemoEntry& demo : demos()) out.emplace_back(demo.id);
  return out;
}

}  // namespace carom::host::test
