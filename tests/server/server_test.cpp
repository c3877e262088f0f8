// The live server as a hostile network sees it, and as its own page does.
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <tuple>
#include <utility>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#if CAROM_WITH_TLS
#include <boost/asio/ssl.hpp>
#include <boost/beast/websocket/ssl.hpp>
#endif

#include "apps/server/requests.h"
#include "apps/server/server.h"
#include "apps/server/shared_files.h"
#include "apps/server/tls.h"

namespace carom::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
namespace fs = std::filesystem;

class LiveServer : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("carom_server_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_ / "page/assets");
    write("page/index.html", "<!doctype html><title>page</title>");
    write("page/main.js", "export {};");
    write("page/engine.wasm", std::string("\0asm", 4));
    write("page/assets/a.css", "body{}");
    write("page/.hidden", "hidden");
    write("secret.txt", "secret");
    fs::create_symlink(folder_ / "secret.txt", folder_ / "page/link.txt");
    start({});
  }
  void TearDown() override {
    server_.reset();
    fs::remove_all(folder_);
  }
  void start(ServerOptions options) {
    options.root = (folder_ / "page").string();
    auto started = Server::start(std::move(options));
    ASSERT_TRUE(started.ok()) << started.error().message;
    server_ = std::move(started).value();
  }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }

  tcp::socket connect() {
    tcp::socket socket(context_);
    socket.connect({asio::ip::make_address("127.0.0.1"), server_->port()});
    return socket;
  }
  std::string authority() const { return "127.0.0.1:" + std::to_string(server_->port()); }

  http::response<http::string_body> get(const std::string& target, const std::string& host = {},
                                        http::verb verb = http::verb::get) {
    tcp::socket socket = connect();
    http::request<http::string_body> request(verb, target, 11);
    request.set(http::field::host, host.empty() ? authority() : host);
    http::write(socket, request);
    beast::flat_buffer buffer;
    http::response_parser<http::string_body> parser;
    if (verb == http::verb::head) parser.skip(true);
    http::read(socket, buffer, parser);
    return parser.release();
  }

  using Stream = websocket::stream<tcp::socket>;
  std::unique_ptr<Stream> upgrade(beast::error_code& error, const std::string& origin = {},
                                  const std::string& host = {}, const std::string& path = "/ws") {
    auto stream = std::make_unique<Stream>(connect());
    stream->set_option(websocket::stream_base::decorator([origin](websocket::request_type& request) {
      if (!origin.empty()) request.set(http::field::origin, origin);
    }));
    stream->handshake(host.empty() ? authority() : host, path, error);
    return stream;
  }
  static std::string say(Stream& stream, const std::string& text) {
    stream.text(true);
    stream.write(asio::buffer(text));
    return hear(stream);
  }
  static std::string hear(Stream& stream) {
    beast::flat_buffer buffer;
    stream.read(buffer);
    return beast::buffers_to_string(buffer.data());
  }

  fs::path folder_;
  asio::io_context context_;
  std::unique_ptr<Server> server_;
};

TEST_F(LiveServer, ServesThePageWithTypesAndHeaders) {
  const auto page = get("/");
  EXPECT_EQ(page.result(), http::status::ok);
  EXPECT_EQ(page.body(), "<!doctype html><title>page</title>");
  EXPECT_EQ(page[http::field::content_type], "text/html; charset=utf-8");
  EXPECT_EQ(page[http::field::cache_control], "no-cache");
  EXPECT_EQ(page["X-Content-Type-Options"], "nosniff");
  EXPECT_EQ(page["Cross-Origin-Opener-Policy"], "same-origin");
  EXPECT_EQ(page["Cross-Origin-Embedder-Policy"], "require-corp");
  EXPECT_NE(page["Content-Security-Policy"].find("default-src 'self'"), boost::string_view::npos);
  EXPECT_EQ(get("/main.js?v=1")[http::field::content_type], "text/javascript; charset=utf-8");
  EXPECT_EQ(get("/engine.wasm")[http::field::content_type], "application/wasm");
  EXPECT_NE(get("/assets/a.css")[http::field::cache_control].find("immutable"), boost::string_view::npos);
  const auto head = get("/main.js", {}, http::verb::head);
  EXPECT_EQ(head.result(), http::status::ok);
  EXPECT_EQ(head[http::field::content_length], "10");
}

TEST_F(LiveServer, NothingOutsideItsFolder) {
  for (const char* target :
       {"/../secret.txt", "/..%2fsecret.txt", "/%2e%2e/secret.txt", "/assets/../../secret.txt",
        "/assets/%2e%2e/%2e%2e/secret.txt", "//../secret.txt", "/..\\secret.txt", "/%5c..%5csecret.txt", "/link.txt",
        "/.hidden", "/%00", "/index.html%00.js", "/%zz", "/%2", "/etc/passwd", "/nothing"}) {
    const auto answer = get(target);
    EXPECT_EQ(answer.result(), http::status::not_found) << target;
    EXPECT_EQ(answer.body().find("secret"), std::string::npos) << target;
  }
}

TEST_F(LiveServer, OnlyReadingMethods) {
  for (const auto verb : {http::verb::post, http::verb::put, http::verb::delete_, http::verb::options})
    EXPECT_EQ(get("/", {}, verb).result(), http::status::method_not_allowed);
}

TEST_F(LiveServer, ForeignHostNamesAreRefused) {
  EXPECT_EQ(get("/", "localhost").result(), http::status::ok);
  EXPECT_EQ(get("/", "[::1]:80").result(), http::status::ok);
  for (const char* host : {"evil.example", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example",
                           "192.168.1.5", "", " "})
    EXPECT_NE(get("/", *host ? host : "@").result(), http::status::ok) << host;
}

TEST_F(LiveServer, ForeignOriginsMayNotDriveIt) {
  beast::error_code error;
  upgrade(error, "http://" + authority());
  EXPECT_FALSE(error) << error.message();
  upgrade(error);  // a program that is no browser
  EXPECT_FALSE(error) << error.message();
  for (const std::string origin :
       {"http://evil.example", "null", "http://127.0.0.1:1", "https://localhost.evil.example", "file://"}) {
    upgrade(error, origin);
    EXPECT_TRUE(error) << origin;
  }
  upgrade(error, {}, "evil.example");
  EXPECT_TRUE(error);
  upgrade(error, {}, {}, "/other");
  EXPECT_TRUE(error);
}

TEST_F(LiveServer, ADemoRunsOverTheWebSocket) {
  beast::error_code error;
  const auto stream = upgrade(error);
  ASSERT_FALSE(error);
  EXPECT_NE(say(*stream, R"({"type":"hello","protocol":1})").find("\"welcome\""), std::string::npos);
  EXPECT_NE(say(*stream, R"({"type":"open","demo":"pyramids"})").find("\"opened\""), std::string::npos);
  int frames = 0;
  for (int i = 0; i < 60 && frames < 5; ++i) {
    const std::string message = hear(*stream);
    if (message.empty() || message[0] != 2) continue;
    ++frames;
    std::uint32_t sequence = 0;
    std::memcpy(&sequence, message.data() + 4, 4);
    stream->text(true);
    stream->write(asio::buffer(R"({"type":"ack","sequence":)" + std::to_string(sequence) + "}"));
  }
  EXPECT_EQ(frames, 5);
  stream->close(websocket::close_code::normal, error);
}

TEST_F(LiveServer, AMessageTooLongEndsOnlyItsOwnConnection) {
  beast::error_code error;
  const auto big = upgrade(error), small = upgrade(error);
  big->text(true);
  big->write(asio::buffer(std::string(5 << 20, ' ')), error);
  beast::flat_buffer buffer;
  big->read(buffer, error);
  EXPECT_TRUE(error);
  EXPECT_NE(say(*small, R"({"type":"hello","protocol":1})").find("welcome"), std::string::npos);
}

TEST_F(LiveServer, GarbageInsteadOfHttp) {
  for (const std::string& garbage :
       {std::string("\0\1\2\3\r\n\r\n", 8), std::string("GET\r\n\r\n"), std::string(100'000, 'A')}) {
    tcp::socket socket = connect();
    beast::error_code error;
    asio::write(socket, asio::buffer(garbage), error);
    socket.shutdown(tcp::socket::shutdown_send, error);
    std::string answer(4096, '\0');
    while (!error) socket.read_some(asio::buffer(answer), error);
  }
  EXPECT_EQ(get("/").result(), http::status::ok);
}

TEST_F(LiveServer, FiftyClientsAndNoMoreThanAllowed) {
  server_.reset();
  ServerOptions options;
  options.max_clients = 50;
  start(options);
  std::vector<std::unique_ptr<Stream>> clients;
  beast::error_code error;
  for (int i = 0; i < 50; ++i) {
    clients.push_back(upgrade(error));
    ASSERT_FALSE(error) << i << ": " << error.message();
    EXPECT_NE(say(*clients.back(), R"({"type":"hello","protocol":1})").find("welcome"), std::string::npos);
    EXPECT_NE(say(*clients.back(), R"({"type":"open","demo":"collision-lab-2d"})").find("opened"), std::string::npos);
  }
  upgrade(error);
  EXPECT_TRUE(error) << "the fifty-first";
  for (const auto& client : clients) {
    bool frame = false;
    for (int i = 0; i < 20 && !frame; ++i) {
      const std::string message = hear(*client);
      frame = !message.empty() && message[0] == 2;
    }
    EXPECT_TRUE(frame);
  }
  clients.clear();
  for (int i = 0; i < 200 && server_->clients() > 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(server_->clients(), 0);
}

TEST_F(LiveServer, AClientThatNeverReadsHoldsNobodyUp) {
  beast::error_code error;
  const auto slow = upgrade(error), quick = upgrade(error);
  slow->text(true);
  slow->write(asio::buffer(std::string(R"({"type":"hello","protocol":1})")), error);
  for (int i = 0; i < 100 && !error; ++i)
    slow->write(asio::buffer(std::string(R"({"type":"open","demo":"collision-lab-3d"})")), error);
  EXPECT_NE(say(*quick, R"({"type":"hello","protocol":1})").find("welcome"), std::string::npos);
}

TEST_F(LiveServer, StopSaysGoodbyeAndIsQuick) {
  beast::error_code error;
  const auto stream = upgrade(error);
  say(*stream, R"({"type":"hello","protocol":1})");
  const auto started = std::chrono::steady_clock::now();
  std::thread stopper([this] { server_->stop(); });
  beast::flat_buffer buffer;
  while (!error) stream->read(buffer, error);
  stopper.join();
  EXPECT_EQ(error, websocket::error::closed);
  EXPECT_LT(std::chrono::steady_clock::now() - started, std::chrono::seconds(3));
}

#if CAROM_WITH_TLS
/// A client that trusts one certificate and nothing else, and looks at the name in it.
class Trusting {
 public:
  Trusting(asio::io_context& context, const std::string& certificate, const std::string& name, unsigned short port)
      : tls_(asio::ssl::context::tls_client), stream_(context, tls_) {
    tls_.add_certificate_authority(asio::buffer(certificate));
    stream_.set_verify_mode(asio::ssl::verify_peer);
    stream_.set_verify_callback(asio::ssl::host_name_verification(name));
    stream_.next_layer().connect({asio::ip::make_address("127.0.0.1"), port});
    stream_.handshake(asio::ssl::stream_base::client, error);
  }
  asio::ssl::stream<tcp::socket>& stream() { return stream_; }
  beast::error_code error;

 private:
  asio::ssl::context tls_;
  asio::ssl::stream<tcp::socket> stream_;
};

TEST_F(LiveServer, SpeaksTlsWithACertificateOfItsOwn) {
  const std::vector<std::string> names{"mybox.example"};
  const auto identity = user_identity(names, (folder_ / "tls").string());
  ASSERT_TRUE(identity.ok()) << identity.error().message;
  EXPECT_EQ(fs::status(folder_ / "tls/tls-key.pem").permissions() & fs::perms::all,
            fs::perms::owner_read | fs::perms::owner_write);
  ServerOptions options;
  options.tls = *identity;
  options.allowed_hosts = names;
  start(std::move(options));
  EXPECT_EQ(server_->url().substr(0, 8), "https://");
  for (const char* name : {"localhost", "127.0.0.1", "mybox.example"}) {
    Trusting client(context_, identity->certificate, name, server_->port());
    EXPECT_FALSE(client.error) << name << ": " << client.error.message();
  }
  EXPECT_TRUE(Trusting(context_, identity->certificate, "elsewhere.example", server_->port()).error);
  const auto stranger = make_identity({});
  ASSERT_TRUE(stranger.ok());
  EXPECT_TRUE(Trusting(context_, stranger->certificate, "localhost", server_->port()).error);

  // Files, one after another on one connection.
  const std::string authority = "localhost:" + std::to_string(server_->port());
  Trusting client(context_, identity->certificate, "localhost", server_->port());
  for (int i = 0; i < 3; ++i) {
    http::request<http::empty_body> request{http::verb::get, "/", 11};
    request.set(http::field::host, authority);
    http::write(client.stream(), request);
    http::response<http::string_body> response;
    beast::flat_buffer buffer;
    http::read(client.stream(), buffer, response);
    EXPECT_EQ(response.result_int(), 200u);
    EXPECT_NE(response.body().find("page"), std::string::npos);
    EXPECT_EQ(response["Cross-Origin-Opener-Policy"], "same-origin");
  }
  // A page at https drives the engine over wss.
  Trusting page(context_, identity->certificate, "localhost", server_->port());
  websocket::stream<asio::ssl::stream<tcp::socket>&> socket(page.stream());
  socket.set_option(websocket::stream_base::decorator(
      [&](websocket::request_type& request) { request.set(http::field::origin, "https://" + authority); }));
  socket.handshake(authority, "/ws");
  socket.write(asio::buffer(std::string("{\"type\":\"hello\",\"protocol\":1}")));
  beast::flat_buffer buffer;
  socket.read(buffer);
  EXPECT_NE(beast::buffers_to_string(buffer.data()).find("welcome"), std::string::npos);

  // Who comes without TLS is told where to go; who sends nonsense is let go, and the server lives on.
  const auto plain = get("/main.js");
  EXPECT_EQ(plain.result_int(), 308u);
  EXPECT_NE(std::string(plain[http::field::location]).find("https://"), std::string::npos);
  for (const std::string& nonsense : {std::string("\x16\x03\x01\xff\xff\x01", 6), std::string(3000, '\x16')}) {
    tcp::socket raw = connect();
    asio::write(raw, asio::buffer(nonsense));
    beast::error_code ignored;
    raw.shutdown(tcp::socket::shutdown_send, ignored);
    char byte[256];
    while (!ignored) raw.read_some(asio::buffer(byte), ignored);
  }
  EXPECT_FALSE(Trusting(context_, identity->certificate, "localhost", server_->port()).error);
}

TEST_F(LiveServer, ACertificateIsKeptAndWrongFilesAreNamed) {
  const std::string folder = (folder_ / "tls").string();
  const auto first = user_identity({}, folder), again = user_identity({}, folder);
  ASSERT_TRUE(first.ok() && again.ok());
  EXPECT_EQ(first->certificate, again->certificate) << "a browser that trusts it need not be asked again";
  const auto print = fingerprint(*first);
  ASSERT_TRUE(print.ok());
  EXPECT_EQ(print->size(), 32u * 3 - 1);
  const std::vector<std::string> names{"another.example"};
  const auto wider = user_identity(names, folder);
  ASSERT_TRUE(wider.ok());
  EXPECT_NE(wider->certificate, first->certificate) << "a name is new";
  const std::string certificate = folder + "/tls-certificate.pem", key = folder + "/tls-key.pem";
  EXPECT_TRUE(read_identity(certificate, key).ok());
  const auto other = make_identity({});
  ASSERT_TRUE(other.ok());
  write("other.pem", other->key);
  for (const auto& [c, k, said] : {std::tuple{folder + "/none.pem", key, "there is no such file"},
                                   {certificate, (folder_ / "secret.txt").string(), "found no key"},
                                   {(folder_ / "secret.txt").string(), key, "found no certificate"},
                                   {certificate, (folder_ / "other.pem").string(), "does not belong"}}) {
    const auto wrong = read_identity(c, k);
    ASSERT_FALSE(wrong.ok()) << said;
    EXPECT_NE(wrong.error().message.find(said), std::string::npos) << wrong.error().message;
  }
  write("tls/tls-key.pem", "nonsense");
  const auto broken = user_identity({}, folder);
  ASSERT_FALSE(broken.ok());
  EXPECT_NE(broken.error().message.find("remove both files"), std::string::npos) << broken.error().message;
  ServerOptions options;
  options.tls = TlsIdentity{"nonsense", "nonsense"};
  const auto refused = Server::start(std::move(options));
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("certificate"), std::string::npos);
}
#endif

TEST_F(LiveServer, ATakenPortIsAClearError) {
  ServerOptions options;
  options.port = server_->port();
  const auto second = Server::start(std::move(options));
  ASSERT_FALSE(second.ok());
  EXPECT_NE(second.error().message.find(std::to_string(server_->port())), std::string::npos);
}

TEST(SharedFiles, AreThoseOfTheScenesAndPresetsAndNoOthers) {
  const fs::path folder = fs::temp_directory_path() / ("carom_shared_files_test_" + std::to_string(::getpid()));
  fs::create_directories(folder / "scenes/parts");
  fs::create_directories(folder / "presets/ball");
  const auto write = [&](const char* name, const char* text) { std::ofstream(folder / name) << text; };
  write("scenes/parts/ground.json", R"({"bodies": [{"name": "ground", "type": "fixed", "shape": {"type": "plane"}}]})");
  write("presets/ball/test.json",
        R"({"description": "a test", "source": "nowhere", "values": {"shape": {"type": "sphere", "radius": "3 m"}}})");
  write("secret.json", "{}");
  fs::create_symlink(folder / "secret.json", folder / "scenes/link.json");
  fs::create_symlink(folder, folder / "presets/up");
  const scene::Resolver files = shared_files({(folder / "scenes").string()}, {(folder / "presets").string()});

  const auto scene = scene::parse_scene(
      R"({"include": ["parts/ground.json"], "bodies": [{"name": "ball", "preset": "ball/test", "position": [0, 9, 0]}]})",
      "dropped.json", files);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  const auto world = scene->instantiate();
  ASSERT_TRUE(world.ok());
  EXPECT_EQ(world->bodies.size(), 2u);

  for (const char* outside : {"../secret.json", "link.json", "presets/../secret.json", "presets/up/secret.json",
                              "/etc/hostname", "presets//etc/hostname", "parts", "", "nothing.json"}) {
    const auto found = files(outside);
    ASSERT_FALSE(found.ok()) << outside;
    EXPECT_NE(found.error().message.find("expected a file"), std::string::npos) << found.error().message;
  }
  fs::remove_all(folder);
}

TEST(Requests, HostNames) {
  EXPECT_EQ(host_name("localhost:80"), "localhost");
  EXPECT_EQ(host_name("[::1]:80"), "::1");
  for (const char* bad : {"", "a:b", "a:123456", "[::1", "a:80:90"}) EXPECT_EQ(host_name(bad), "") << bad;
  const std::vector<std::string> allowed = {"MyBox.local"};
  EXPECT_TRUE(host_allowed("mybox.local:8080", true, allowed));
  EXPECT_TRUE(host_allowed("192.168.1.5:8080", true, allowed));
  EXPECT_FALSE(host_allowed("192.168.1.5:8080", false, allowed));
  EXPECT_FALSE(host_allowed("other.local", true, allowed));
}

}  // namespace
}  // namespace carom::server
