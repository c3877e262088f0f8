#include "apps/server/server.h"

#include <chrono>
#include <utility>

#include <boost/asio/buffer.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/strand.hpp>

#include "apps/server/server_state.h"

namespace carom::server {

namespace asio = boost::asio;
using tcp = asio::ip::tcp;
using ErrorCode = boost::system::error_code;

void Server::Implementation::accept() {
  acceptor.async_accept(asio::make_strand(context), [this](ErrorCode error, tcp::socket socket) {
    if (stopping) return;
    if (!error && connections < 512) {
      ErrorCode ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      serve_connection(*this, std::move(socket));
    }
    if (acceptor.is_open()) accept();
  });
}

core::Result<std::unique_ptr<Server>> Server::start(ServerOptions options) {
  auto self = std::make_unique<Implementation>();
  ErrorCode error;
  const std::string where = options.address + " port " + std::to_string(options.port);
  const auto address = asio::ip::make_address(options.address, error);
  if (error) return core::Error{"address " + options.address + ": expected a number such as 127.0.0.1 or ::1"};
  self->beyond_loopback = !address.is_loopback();
  const tcp::endpoint endpoint(address, options.port);
  self->acceptor.open(endpoint.protocol(), error);
  if (!error) self->acceptor.set_option(asio::socket_base::reuse_address(true), error);
  if (!error) self->acceptor.bind(endpoint, error);
  if (!error) self->acceptor.listen(asio::socket_base::max_listen_connections, error);
  if (error) return core::Error{"cannot listen on " + where + ": " + error.message() + "; try another --port"};
  if (options.tls) {
#if CAROM_WITH_TLS
    self->tls = std::make_unique<asio::ssl::context>(asio::ssl::context::tls_server);
    self->tls->set_options(asio::ssl::context::default_workarounds | asio::ssl::context::no_tlsv1 |
                           asio::ssl::context::no_tlsv1_1);
    self->tls->use_certificate_chain(asio::buffer(options.tls->certificate), error);
    if (error) return core::Error{"the certificate cannot be used: " + error.message() + "; expected PEM text"};
    self->tls->use_private_key(asio::buffer(options.tls->key), asio::ssl::context::pem, error);
    if (error)
      return core::Error{"the key cannot be used with this certificate: " + error.message() + "; expected PEM text"};
#else
    return core::Error{"this build has no TLS: install libssl-dev and build again"};
#endif
  }
  const int threads = options.threads < 1 ? 1 : options.threads;
  self->options = std::move(options);
  self->accept();
  Implementation* raw = self.get();
  for (int i = 0; i < threads; ++i) self->threads.emplace_back([raw] { raw->context.run(); });
  return std::unique_ptr<Server>(new Server(std::move(self)));
}

Server::Server(std::unique_ptr<Implementation> self) : self_(std::move(self)) {}
Server::~Server() { stop(); }

unsigned short Server::port() const {
  ErrorCode error;
  const tcp::endpoint endpoint = self_->acceptor.local_endpoint(error);
  return error ? self_->options.port : endpoint.port();
}
std::string Server::url() const {
  const std::string& a = self_->options.address;
  const std::string name = a == "0.0.0.0" || a == "::"        ? "localhost"
                           : a.find(':') != std::string::npos ? "[" + a + "]"
                                                              : a;
  return (self_->secure() ? "https://" : "http://") + name + ":" + std::to_string(port()) + "/";
}
int Server::clients() const { return self_->clients; }

void Server::stop() {
  if (self_->stopping.exchange(true)) return;
  self_->options.port = port();
  asio::post(self_->context, [this] {
    ErrorCode ignored;
    self_->acceptor.close(ignored);
    const std::lock_guard lock(self_->mutex);
    for (const std::weak_ptr<AnySession>& one : self_->sessions)
      if (const auto session = one.lock()) session->close();
  });
  // A moment for the goodbyes, then the rest is cut.
  for (int i = 0; i < 50 && self_->clients > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  self_->context.stop();
  for (std::thread& thread : self_->threads) thread.join();
}

}  // namespace carom::server
