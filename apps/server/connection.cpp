// Requests for files and pages, plain or under TLS; a request for the WebSocket becomes a Session.
#include <filesystem>
#include <optional>

#include "apps/server/requests.h"
#include "apps/server/session.h"

namespace carom::server {

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

/// One HTTP connection; becomes a Session when it asks for the WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Server::Implementation& server, tcp::socket&& socket)
      : server_(server), stream_(beast::tcp_stream(std::move(socket))) {
    buffer_.max_size(64 << 10);
    ++server_.connections;
  }
  ~Connection() { --server_.connections; }

  void start() {
#if CAROM_WITH_TLS
    if (server_.secure()) return greet();
#endif
    read();
  }

 private:
#if CAROM_WITH_TLS
  /// Looks at the first bytes: a greeting of TLS, or a request by who typed http.
  void greet() {
    stream_.next_layer().expires_after(std::chrono::seconds(20));
    beast::async_detect_ssl(stream_, buffer_, [self = shared_from_this()](beast::error_code error, bool tls) {
      if (error) return;
      if (tls)
        self->shake_hands();
      else
        self->read();
    });
  }
  void shake_hands() {
    stream_.next_layer().expires_after(std::chrono::seconds(20));
    stream_.async_handshake(*server_.tls, buffer_.data(),
                            [self = shared_from_this()](beast::error_code error, std::size_t used) {
                              if (error) return;
                              self->buffer_.consume(used);
                              self->read();
                            });
  }
#endif
  void read() {
    parser_.emplace();
    parser_->header_limit(16 << 10);
    parser_->body_limit(64 << 10);
    stream_.next_layer().expires_after(std::chrono::seconds(20));
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error == http::error::end_of_stream) {
        self->end();
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
    // Who comes without TLS where it is spoken is told where to go.
    if (!stream_.secure() && server_.secure()) return redirect(authority, text(request.target()));
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
      const auto session = std::make_shared<Session>(server_, std::move(stream_));
      {
        const std::lock_guard lock(server_.mutex);
        std::erase_if(server_.sessions, [](const std::weak_ptr<AnySession>& one) { return one.expired(); });
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
      const auto empty = std::make_shared<http::response<http::string_body>>();
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

  void redirect(std::string_view authority, std::string_view target) {
    if (!host_allowed(authority, server_.beyond_loopback, server_.options.allowed_hosts) || target.substr(0, 1) != "/")
      return answer(http::status::bad_request, "this server speaks https\n", false);
    location_ = "https://" + std::string(authority) + std::string(target);
    answer(http::status::permanent_redirect, "this server speaks https: " + location_ + "\n", false);
  }

  void end() {
    stream_.next_layer().expires_after(std::chrono::seconds(5));
    stream_.async_end([self = shared_from_this()](beast::error_code) {});
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
    if (!location_.empty()) response.set(http::field::location, location_);
  }

  template <class Response>
  void send(const std::shared_ptr<Response>& response) {
    stream_.next_layer().expires_after(std::chrono::seconds(30));
    http::async_write(stream_, *response, [self = shared_from_this(), response](beast::error_code error, std::size_t) {
      if (error || !response->keep_alive()) {
        self->end();
        return;
      }
      self->read();
    });
  }

  Server::Implementation& server_;
  Stream stream_;
  beast::flat_buffer buffer_;
  std::string location_;
  std::optional<http::request_parser<http::string_body>> parser_;
  bool head_ = false, keep_alive_ = true;
};

}  // namespace

void serve_connection(Server::Implementation& server, tcp::socket&& socket) {
  const auto executor = socket.get_executor();
  asio::dispatch(executor, [&server, socket = std::make_shared<tcp::socket>(std::move(socket))] {
    std::make_shared<Connection>(server, std::move(*socket))->start();
  });
}

}  // namespace carom::server
