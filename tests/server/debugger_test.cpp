// The visual debugger: a page at a game's own world, which the game steps.
#include "apps/debugger/debugger.h"

#include <gtest/gtest.h>

#include <atomic>
#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

namespace carom::debugger {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Json = nlohmann::json;

/// A page in a thread of its own: keeps what it was told, and says what it is asked to say.
class FarPage {
 public:
  explicit FarPage(const std::string& url) : socket_(context_) {
    const std::string port = url.substr(url.rfind(':') + 1, url.rfind('/') - url.rfind(':') - 1);
    socket_.next_layer().connect({asio::ip::make_address("127.0.0.1"), std::uint16_t(std::stoi(port))});
    socket_.set_option(websocket::stream_base::decorator([port](websocket::request_type& request) {
      request.set(beast::http::field::origin, "http://127.0.0.1:" + port);
    }));
    socket_.handshake("127.0.0.1:" + port, "/ws");
    reader_ = std::thread([this] { read(); });
  }
  ~FarPage() {
    beast::error_code ignored;
    socket_.next_layer().shutdown(tcp::socket::shutdown_both, ignored);
    reader_.join();
  }
  void send(const Json& message) {
    const std::lock_guard lock(writing_);
    socket_.text(true);
    beast::error_code ignored;
    socket_.write(asio::buffer(message.dump()), ignored);
  }
  Json last(const std::string& type) {
    const std::lock_guard lock(reading_);
    for (std::size_t i = texts_.size(); i-- > 0;)
      if (texts_[i]["type"] == type) return texts_[i];
    return nullptr;
  }
  std::atomic<int> frames{0};

 private:
  void read() {
    for (;;) {
      beast::flat_buffer buffer;
      beast::error_code error;
      socket_.read(buffer, error);
      if (error) return;
      const std::string data = beast::buffers_to_string(buffer.data());
      if (socket_.got_text()) {
        const std::lock_guard lock(reading_);
        texts_.push_back(Json::parse(data));
      } else if (data[0] == 2) {
        std::uint32_t sequence;
        std::memcpy(&sequence, data.data() + 4, 4);
        ++frames;
        send({{"type", "ack"}, {"sequence", sequence}});
      }
    }
  }

  asio::io_context context_;
  websocket::stream<tcp::socket> socket_;
  std::mutex reading_, writing_;
  std::vector<Json> texts_;
  std::thread reader_;
};

class AttachedGame : public testing::Test {
 protected:
  AttachedGame() {
    rigid::BodyDef<rigid::Dim3> floor;
    floor.type = rigid::BodyType::fixed;
    (void)world_.add_shape(*world_.create_body(floor), geometry::Plane{});
    ball_ = drop(5);
    DebuggerOptions options;
    options.port = 0;
    options.title = "The game";
    options.say_where = false;
    auto made = attach(world_, options);
    EXPECT_TRUE(made.ok());
    debugger_.emplace(std::move(made).value());
  }
  rigid::BodyId drop(double height) {
    rigid::BodyDef<rigid::Dim3> body;
    body.position = {0, height, 0};
    const rigid::BodyId id = *world_.create_body(body);
    (void)world_.add_shape(id, geometry::Sphere{0.5f});
    return id;
  }
  /// Turns of the game's loop until something is so, for at most ten seconds.
  template <class F>
  bool play_until(F&& so) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (!so()) {
      if (std::chrono::steady_clock::now() > end) return false;
      turn();
    }
    return true;
  }
  void turn() {
    if (debugger_->update()) (void)world_.step(1.0f / 60);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  void open(FarPage& page) {
    page.send({{"type", "hello"}, {"protocol", 1}});
    page.send({{"type", "open"}, {"demo", "game"}});
    EXPECT_TRUE(play_until([&] { return page.frames > 2; }));
  }

  rigid::World3 world_;
  rigid::BodyId ball_;
  std::optional<Debugger> debugger_;
};

TEST_F(AttachedGame, IsWatchedPausedAndStepped) {
  FarPage page(debugger_->url());
  open(page);
  EXPECT_EQ(page.last("welcome")["engine"], "game");
  EXPECT_EQ(page.last("welcome")["demos"].size(), 1u);
  EXPECT_EQ(page.last("opened")["title"], "The game");
  EXPECT_EQ(page.last("scene")["bodies"].size(), 2u);
  page.send({{"type", "pause"}});
  ASSERT_TRUE(play_until([&] { return !debugger_->update(); }));
  const std::uint64_t held = world_.step_count();
  for (int i = 0; i < 20; ++i) turn();
  EXPECT_EQ(world_.step_count(), held);
  page.send({{"type", "step"}, {"count", 3}});
  ASSERT_TRUE(play_until([&] { return world_.step_count() == held + 3; }));
  for (int i = 0; i < 20; ++i) turn();
  EXPECT_EQ(world_.step_count(), held + 3);
  EXPECT_TRUE(play_until([&] { return page.last("status")["step"] == held + 3; }));
  page.send({{"type", "run"}});
  EXPECT_TRUE(play_until([&] { return world_.step_count() > held + 10; }));
}

TEST_F(AttachedGame, BodiesThatComeAndGoAreShownAndHandsPull) {
  FarPage page(debugger_->url());
  open(page);
  (void)drop(9);
  EXPECT_TRUE(play_until([&] { return page.last("bodies").is_object() && page.last("bodies")["add"].size() == 1; }));
  (void)world_.destroy_body(ball_);
  EXPECT_TRUE(play_until([&] { return page.last("bodies")["remove"].size() == 1; }));
  page.send({{"type", "pause"}});
  ASSERT_TRUE(play_until([&] { return !debugger_->update(); }));
  std::vector<rigid::BodyId> all;
  world_.bodies(all);
  const math::Vec3d at = world_.state(all.back())->pose.position;
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", {at.x, at.y, 20}}, {"direction", {0, 0, -1}}});
  EXPECT_TRUE(play_until([&] { return world_.counters().joints == 1; }));
  // The game ends while the page still holds: nothing of the hand stays in its world.
  debugger_.reset();
  EXPECT_EQ(world_.counters().joints, 0);
}

TEST_F(AttachedGame, WhatBelongsToTheGameIsRefused) {
  FarPage page(debugger_->url());
  open(page);
  page.send({{"type", "restart"}});
  EXPECT_TRUE(play_until([&] { return page.last("error").is_object(); }));
  EXPECT_NE(page.last("error")["message"].get<std::string>().find("keeps its own time"), std::string::npos);
}

TEST_F(AttachedGame, ATakenPortAndABadStepAreClear) {
  DebuggerOptions options;
  const std::string url = debugger_->url();
  options.port = std::uint16_t(std::stoi(url.substr(url.rfind(':') + 1)));
  options.say_where = false;
  EXPECT_FALSE(attach(world_, options).ok());
  options.port = 0;
  options.dt = 0;
  const auto bad = attach(world_, options);
  ASSERT_FALSE(bad.ok());
  EXPECT_NE(bad.error().message.find("dt"), std::string::npos);
}

}  // namespace
}  // namespace carom::debugger
