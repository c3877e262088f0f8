// What the connections of one server share.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#if CAROM_WITH_TLS
#include <boost/asio/ssl/context.hpp>
#endif

#include "apps/server/server.h"

namespace carom::server {

/// A page, whatever it came over.
class AnySession {
 public:
  virtual ~AnySession() = default;
  virtual void close() = 0;
};

struct Server::Implementation {
  // What connections touch while they end comes before the context that ends them.
  ServerOptions options;
  std::atomic<int> connections{0}, clients{0};
  std::atomic<bool> stopping{false};
  std::mutex mutex;
  std::vector<std::weak_ptr<AnySession>> sessions;
  bool beyond_loopback = false;
#if CAROM_WITH_TLS
  std::unique_ptr<boost::asio::ssl::context> tls;  ///< null: plain connections
#endif
  boost::asio::io_context context;
  boost::asio::ip::tcp::acceptor acceptor{context};
  std::vector<std::thread> threads;

  bool secure() const { return options.tls.has_value(); }
  void accept();
  void log(const std::string& line) {
    if (options.log) options.log(line);
  }
};

/// Serves one connection until it ends.
void serve_connection(Server::Implementation& server, boost::asio::ip::tcp::socket&& socket);

}  // namespace carom::server
