#include "apps/server/stream.h"

#if CAROM_WITH_TLS
#include <boost/asio/ssl/stream_base.hpp>
#include <boost/beast/websocket/ssl.hpp>
#endif

namespace carom::server {

beast::tcp_stream& Stream::next_layer() {
#if CAROM_WITH_TLS
  if (auto* tls = std::get_if<1>(&layers_)) return tls->next_layer();
#endif
  return std::get<0>(layers_);
}

#if CAROM_WITH_TLS
void Stream::async_handshake(asio::ssl::context& context, asio::const_buffer read_before, Done done) {
  beast::tcp_stream plain = std::move(std::get<0>(layers_));
  layers_.emplace<1>(std::move(plain), context)
      .async_handshake(asio::ssl::stream_base::server, read_before, std::move(done));
}
#endif

void Stream::async_end(Ended done) {
#if CAROM_WITH_TLS
  if (auto* tls = std::get_if<1>(&layers_)) return tls->async_shutdown(std::move(done));
#endif
  beast::error_code error;
  next_layer().socket().shutdown(asio::ip::tcp::socket::shutdown_send, error);
  done(error);
}

void Stream::read(const Some<asio::mutable_buffer>& buffers, Done done) {
  std::visit([&](auto& layer) { layer.async_read_some(buffers, std::move(done)); }, layers_);
}
void Stream::write(const Some<asio::const_buffer>& buffers, Done done) {
  std::visit([&](auto& layer) { layer.async_write_some(buffers, std::move(done)); }, layers_);
}
void Stream::teardown(beast::role_type role, Ended done) {
  using beast::websocket::async_teardown;
  std::visit([&](auto& layer) { async_teardown(role, layer, std::move(done)); }, layers_);
}

}  // namespace carom::server
