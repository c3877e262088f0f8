// A server for pages and their simulations: files over HTTP, one SimulationHost for each WebSocket at /ws.
// It answers on loopback unless told otherwise, and only to pages that it served itself.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/host/host.h"

namespace carom::server {

/// What a server proves itself with, as PEM texts (tls.h).
struct TlsIdentity {
  std::string certificate, key;
};

struct ServerOptions {
  std::string address = "127.0.0.1";
  unsigned short port = 0;                 ///< 0: any free one
  std::string root;                        ///< folder of the page; empty or missing: a page that says how to build it
  std::vector<std::string> allowed_hosts;  ///< names beyond loopback that may stand in a Host header
  std::optional<TlsIdentity> tls;          ///< https and wss instead of http and ws
  int max_clients = 64;
  int threads = 2;                                  ///< that serve all connections together
  double frame_interval = 1.0 / 60;                 ///< s
  int idle_seconds = 120;                           ///< silent connections are pinged, then closed
  std::function<host::HostOptions()> host_options;  ///< for every new simulation
  /// Where simulations touch what is not theirs alone: every use of one runs within it. Empty: at once.
  std::function<void(const std::function<void()>&)> guard;
  std::function<void(const std::string&)> log;  ///< one line a connection; called from any thread
};

class Server {
 public:
  /// Listens at once; errors name the address, the port and why.
  static core::Result<std::unique_ptr<Server>> start(ServerOptions options);
  ~Server();
  unsigned short port() const;
  std::string url() const;
  int clients() const;
  /// Says goodbye to every client and ends the threads. Called by the destructor too.
  void stop();

  struct Implementation;

 private:
  explicit Server(std::unique_ptr<Implementation> self);
  std::unique_ptr<Implementation> self_;
};

}  // namespace carom::server
