// The bytes of a connection, plain or under TLS, as one type: what is built on it (Beast's requests and WebSockets) is
// compiled once, and its handlers reach the socket as one type too.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <utility>
#include <variant>

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#if CAROM_WITH_TLS
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#endif

namespace carom::server {

namespace asio = boost::asio;
namespace beast = boost::beast;

/// An AsyncStream of Boost.Asio.
class Stream {
 public:
  using next_layer_type = beast::tcp_stream;
  using executor_type = beast::tcp_stream::executor_type;
  using Done = std::function<void(beast::error_code, std::size_t)>;
  using Ended = std::function<void(beast::error_code)>;

  explicit Stream(beast::tcp_stream&& plain) : layers_(std::move(plain)) {}

  /// With the timeouts.
  beast::tcp_stream& next_layer();
  const beast::tcp_stream& next_layer() const { return const_cast<Stream&>(*this).next_layer(); }
  executor_type get_executor() { return next_layer().get_executor(); }
  bool secure() const { return layers_.index() != 0; }

#if CAROM_WITH_TLS
  /// The server's part; `read_before` has come already, `done` tells how much of it was used.
  void async_handshake(asio::ssl::context& context, asio::const_buffer read_before, Done done);
#endif
  /// Says goodbye: under TLS in its words.
  void async_end(Ended done);

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    read(first_of<asio::mutable_buffer>(buffers), as_function<Done>(std::forward<Handler>(handler)));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    write(first_of<asio::const_buffer>(buffers), as_function<Done>(std::forward<Handler>(handler)));
  }

  /// How Beast ends a WebSocket.
  template <class Handler>
  friend void async_teardown(beast::role_type role, Stream& stream, Handler&& handler) {
    stream.teardown(role, as_function<Ended>(std::forward<Handler>(handler)));
  }

 private:
  template <class Buffer>
  using Some = std::array<Buffer, 8>;
  /// A call may move less than it was given, so the first ones will do; empty ones are none.
  template <class Buffer, class Buffers>
  static Some<Buffer> first_of(const Buffers& buffers) {
    Some<Buffer> some;
    std::size_t count = 0;
    const auto end = asio::buffer_sequence_end(buffers);
    for (auto i = asio::buffer_sequence_begin(buffers); i != end && count < some.size(); ++i)
      if (const Buffer buffer(*i); buffer.size() != 0) some[count++] = buffer;
    return some;
  }
  /// Handlers can only be moved, and give back their memory before they run.
  template <class Function, class Handler>
  static Function as_function(Handler&& handler) {
    return [kept = std::make_shared<std::decay_t<Handler>>(std::forward<Handler>(handler))](auto... result) mutable {
      auto last = std::move(*kept);
      kept.reset();
      last(result...);
    };
  }
  void read(const Some<asio::mutable_buffer>& buffers, Done done);
  void write(const Some<asio::const_buffer>& buffers, Done done);
  void teardown(beast::role_type role, Ended done);

#if CAROM_WITH_TLS
  std::variant<beast::tcp_stream, beast::ssl_stream<beast::tcp_stream>> layers_;
#else
  std::variant<beast::tcp_stream> layers_;
#endif
};

}  // namespace carom::server
