// One page and its simulation over a WebSocket, plain or under TLS.
#pragma once

#include <chrono>
#include <functional>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "apps/server/server_state.h"
#include "apps/server/stream.h"

namespace carom::server {

namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

/// One page and its simulation, on its own strand.
class Session : public AnySession, public std::enable_shared_from_this<Session> {
 public:
  Session(Server::Implementation& server, Stream&& stream)
      : server_(server),
        stream_(std::move(stream)),
        timer_(stream_.get_executor()),
        host_(server.options.host_options ? server.options.host_options() : host::HostOptions{}) {
    ++server_.clients;
  }
  ~Session() override {
    guarded([this] { host_.close(); });
    --server_.clients;
  }

  void start(const http::request<http::empty_body>& request) {
    // From here on the WebSocket has timeouts of its own.
    beast::get_lowest_layer(stream_).expires_never();
    websocket::stream_base::timeout timeouts{};
    timeouts.handshake_timeout = std::chrono::seconds(10);
    timeouts.idle_timeout = std::chrono::seconds(server_.options.idle_seconds);
    timeouts.keep_alive_pings = true;
    stream_.set_option(timeouts);
    stream_.read_message_max(4 << 20);
    stream_.auto_fragment(false);
    stream_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (error) return;
      self->last_ = Clock::now();
      self->read();
      self->tick();
    });
  }

  void close() override {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] {
      if (std::exchange(self->closing_, true)) return;
      self->timer_.cancel();
      self->stream_.async_close(websocket::close_code::going_away, [self](beast::error_code) {});
    });
  }

 private:
  void guarded(const std::function<void()>& work) {
    if (server_.options.guard)
      server_.options.guard(work);
    else
      work();
  }

  void read() {
    stream_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error) {
        self->closing_ = true;
        self->timer_.cancel();
        return;
      }
      const auto data = self->buffer_.data();
      const std::string_view bytes(static_cast<const char*>(data.data()), data.size());
      self->guarded([&] {
        if (self->stream_.got_text())
          self->host_.receive(bytes);
        else
          self->host_.receive_binary(bytes);
      });
      self->buffer_.consume(self->buffer_.size());
      self->write();
      // A flood of messages must not starve the simulation, nor answers pile up: read on when they have gone.
      if (!self->writing_)
        self->read();
      else
        self->read_waits_ = true;
    });
  }

  void tick() {
    if (closing_) return;
    timer_.expires_after(
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(server_.options.frame_interval)));
    timer_.async_wait([self = shared_from_this()](beast::error_code error) {
      if (error || self->closing_) return;
      const Clock::time_point now = Clock::now();
      self->guarded([&] { self->host_.advance(std::chrono::duration<double>(now - self->last_).count()); });
      self->last_ = now;
      self->write();
      self->tick();
    });
  }

  void write() {
    if (writing_ || closing_) return;
    if (!host_.take(message_)) {
      if (std::exchange(read_waits_, false)) read();
      return;
    }
    writing_ = true;
    stream_.text(message_.text);
    stream_.async_write(asio::buffer(message_.data), [self = shared_from_this()](beast::error_code error, std::size_t) {
      self->writing_ = false;
      if (error) {
        self->closing_ = true;
        self->timer_.cancel();
        return;
      }
      self->write();
    });
  }

  Server::Implementation& server_;
  websocket::stream<Stream, false> stream_;  // false: messages are not compressed
  asio::steady_timer timer_;
  beast::flat_buffer buffer_{8 << 20};
  host::SimulationHost host_;
  host::Message message_;
  Clock::time_point last_;
  bool writing_ = false, closing_ = false, read_waits_ = false;
};

}  // namespace carom::server
