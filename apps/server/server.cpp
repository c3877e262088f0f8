#include "apps/server/server.h"

#include <atomic>
#include <chrono>
#include <mutex>
#include <thread>
#include <utility>

#include <boost/asio/dispatch.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "apps/server/requests.h"

namespace carom::server {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;

namespace {

constexpr const char* security_policy =
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; font-src 'self' data:; connect-src 'self' data: blob:; worker-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'";

constexpr const char* no_page =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Carom</title>"
    "<body style=\"font:16px/1.5 sans-serif;max-width:40em;margin:4em auto;padding:0 1em\"><h1>Carom</h1>"
    "<p>The engine runs and its WebSocket is open at <code>/ws</code>, but the playground has not been built. "
    "Run <code>./play</code> in the repository, or build the page with <code>npm ci &amp;&amp; npm run build</code> in "
    "<code>apps/playground</code>, and load this page again.</p></body></html>";

}  // namespace

class Session;

struct Server::Implementation {
  // What connections touch while they end comes before the context that ends them.
  ServerOptions options;
  std::atomic<int> connections{0}, clients{0};
  std::atomic<bool> stopping{false};
  std::mutex mutex;
  std::vector<std::weak_ptr<Session>> sessions;
  bool beyond_loopback = false;
  asio::io_context context;
  tcp::acceptor acceptor{context};
  std::vector<std::thread> threads;

  void accept();
  void log(const std::string& line) {
    if (options.log) options.log(line);
  }
};

/// One page and its simulation, on its own strand.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Server::Implementation& server, tcp::socket&& socket)
      : server_(server),
        stream_(std::move(socket)),
        timer_(stream_.get_executor()),
        host_(server.options.host_options ? server.options.host_options() : host::HostOptions{}) {
    ++server_.clients;
  }
  ~Session() {
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

  void close() {
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
  websocket::stream<beast::tcp_stream> stream_;
  asio::steady_timer timer_;
  beast::flat_buffer buffer_{8 << 20};
  host::SimulationHost host_;
  host::Message message_;
  Clock::time_point last_;
  bool writing_ = false, closing_ = false, read_waits_ = false;
};

/// One HTTP connection; becomes a Session when it asks for the WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Server::Implementation& server, tcp::socket&& socket) : server_(server), stream_(std::move(socket)) {
    ++server_.connections;
  }
  ~Connection() { --server_.connections; }

  void start() {
    asio::dispatch(stream_.get_executor(), [self = shared_from_this()] { self->read(); });
  }

 private:
  void read() {
    parser_.emplace();
    parser_->header_limit(16 << 10);
    parser_->body_limit(64 << 10);
    stream_.expires_after(std::chrono::seconds(20));
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error == http::error::end_of_stream) {
        beast::error_code ignored;
        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        return;
      }
      if (error == http::error::header_limit || error == http::error::body_limit)
        return self->answer(http::status::payload_too_large, "request too large\n", false);
      if (error) return;
      self->handle(self->parser_->release());
    });
  }

  void handle(http::request<http::string_body> request) {
    const auto text = [](boost::string_view v) { return std::string_view(v.data(), v.size()); };
    const std::string_view authority = text(request[http::field::host]);
    head_ = request.method() == http::verb::head;
    keep_alive_ = request.keep_alive();
    if (!host_allowed(authority, server_.beyond_loopback, server_.options.allowed_hosts))
      return answer(http::status::misdirected_request,
                    "this server does not go by the name in the Host header; start it with --allow-host NAME\n");
    const std::string_view target = text(request.target());
    if (websocket::is_upgrade(request)) {
      if (target != "/ws") return answer(http::status::not_found, "the WebSocket is at /ws\n");
      if (!origin_allowed(text(request[http::field::origin]), authority))
        return answer(http::status::forbidden, "a page of another origin may not drive this server\n");
      if (server_.clients >= server_.options.max_clients)
        return answer(http::status::service_unavailable, "too many clients; close another page first\n");
      http::request<http::empty_body> upgrade(request.base());
      const auto session = std::make_shared<Session>(server_, stream_.release_socket());
      {
        const std::lock_guard lock(server_.mutex);
        std::erase_if(server_.sessions, [](const std::weak_ptr<Session>& one) { return one.expired(); });
        server_.sessions.push_back(session);
      }
      server_.log("page connected");
      return session->start(upgrade);
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return answer(http::status::method_not_allowed, "only GET and HEAD\n");
    serve(target);
  }

  void serve(std::string_view target) {
    const std::filesystem::path root = server_.options.root;
    std::error_code missing;
    if (root.empty() || !std::filesystem::is_directory(root, missing)) {
      if (target == "/" || target == "/index.html")
        return answer(http::status::ok, no_page, true, "text/html; charset=utf-8");
      return answer(http::status::not_found, "not found\n");
    }
    const std::optional<std::filesystem::path> file = resolve_target(root, target);
    if (!file) return answer(http::status::not_found, "not found\n");
    const auto response = std::make_shared<http::response<http::file_body>>();
    beast::error_code error;
    response->body().open(file->c_str(), beast::file_mode::scan, error);
    if (error) return answer(http::status::not_found, "not found\n");
    const std::uint64_t size = response->body().size();
    const std::string type(content_type(*file));
    const bool hashed = file->parent_path().filename() == "assets";
    if (head_) {
      const auto empty = std::make_shared<http::response<http::empty_body>>();
      fields(*empty, type, hashed);
      empty->content_length(size);
      return send(empty);
    }
    fields(*response, type, hashed);
    response->content_length(size);
    send(response);
  }

  void answer(http::status status, std::string body, bool keep = true, const char* type = "text/plain; charset=utf-8") {
    const auto response = std::make_shared<http::response<http::string_body>>();
    response->result(status);
    keep_alive_ = keep_alive_ && keep;
    fields(*response, type, false);
    response->content_length(body.size());
    if (!head_) response->body() = std::move(body);
    send(response);
  }

  template <class Response>
  void fields(Response& response, const std::string& type, bool immutable) {
    response.version(11);
    response.keep_alive(keep_alive_);
    response.set(http::field::server, "carom");
    response.set(http::field::content_type, type);
    response.set(http::field::cache_control, immutable ? "public, max-age=31536000, immutable" : "no-cache");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Cross-Origin-Opener-Policy", "same-origin");
    response.set("Cross-Origin-Embedder-Policy", "require-corp");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Content-Security-Policy", security_policy);
  }

  template <class Response>
  void send(const std::shared_ptr<Response>& response) {
    stream_.expires_after(std::chrono::seconds(30));
    const auto serializer = std::make_shared<http::response_serializer<typename Response::body_type>>(*response);
    if (head_) serializer->split(true);
    const auto done = [self = shared_from_this(), response, serializer](beast::error_code error, std::size_t) {
      if (error || !response->keep_alive()) {
        beast::error_code ignored;
        self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
        return;
      }
      self->read();
    };
    if (head_)
      http::async_write_header(stream_, *serializer, done);
    else
      http::async_write(stream_, *serializer, done);
  }

  Server::Implementation& server_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{64 << 10};
  std::optional<http::request_parser<http::string_body>> parser_;
  bool head_ = false, keep_alive_ = true;
};

void Server::Implementation::accept() {
  acceptor.async_accept(asio::make_strand(context), [this](beast::error_code error, tcp::socket socket) {
    if (stopping) return;
    if (!error && connections < 512) {
      beast::error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<Connection>(*this, std::move(socket))->start();
    }
    if (acceptor.is_open()) accept();
  });
}

core::Result<std::unique_ptr<Server>> Server::start(ServerOptions options) {
  auto self = std::make_unique<Implementation>();
  beast::error_code error;
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
  beast::error_code error;
  const tcp::endpoint endpoint = self_->acceptor.local_endpoint(error);
  return error ? self_->options.port : endpoint.port();
}
std::string Server::url() const {
  const std::string& a = self_->options.address;
  const std::string name = a == "0.0.0.0" || a == "::"        ? "localhost"
                           : a.find(':') != std::string::npos ? "[" + a + "]"
                                                              : a;
  return "http://" + name + ":" + std::to_string(port()) + "/";
}
int Server::clients() const { return self_->clients; }

void Server::stop() {
  if (self_->stopping.exchange(true)) return;
  self_->options.port = port();
  asio::post(self_->context, [this] {
    beast::error_code ignored;
    self_->acceptor.close(ignored);
    const std::lock_guard lock(self_->mutex);
    for (const std::weak_ptr<Session>& one : self_->sessions)
      if (const auto session = one.lock()) session->close();
  });
  // A moment for the goodbyes, then the rest is cut.
  for (int i = 0; i < 50 && self_->clients > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  self_->context.stop();
  for (std::thread& thread : self_->threads) thread.join();
}

}  // namespace carom::server
