#include <arpa/inet.h>
#include <fcntl.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <unistd.h>

#include <sys/wait.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command/command.h"
#include "apps/host/scene_demo.h"
#if CAROM_WITH_SERVER
#include "apps/server/server.h"
#include "apps/server/shared_files.h"
#include "apps/server/tls.h"
#endif

namespace carom::command {

#if CAROM_WITH_SERVER

namespace {

/// Shows the address in the desktop's browser, where there is a desktop.
void open_browser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  const pid_t child = fork();
  if (child == 0) {
    // A grandchild, so that nobody has to wait for the browser.
    if (fork() == 0) {
      const int null = ::open("/dev/null", O_RDWR);
      dup2(null, STDIN_FILENO);
      dup2(null, STDOUT_FILENO);
      dup2(null, STDERR_FILENO);
      execlp("xdg-open", "xdg-open", url.c_str(), static_cast<char*>(nullptr));
    }
    _exit(0);
  }
  if (child > 0) waitpid(child, nullptr, 0);
}

/// The IPv4 addresses by which other devices of the network reach this machine.
std::vector<std::string> network_addresses() {
  std::vector<std::string> out;
  ifaddrs* all = nullptr;
  if (getifaddrs(&all) != 0) return out;
  for (const ifaddrs* one = all; one != nullptr; one = one->ifa_next) {
    if (one->ifa_addr == nullptr || one->ifa_addr->sa_family != AF_INET) continue;
    if ((one->ifa_flags & IFF_UP) == 0 || (one->ifa_flags & IFF_LOOPBACK) != 0) continue;
    char text[INET_ADDRSTRLEN];
    const auto* address = reinterpret_cast<const sockaddr_in*>(one->ifa_addr);
    if (inet_ntop(AF_INET, &address->sin_addr, text, sizeof text) != nullptr) out.emplace_back(text);
  }
  freeifaddrs(all);
  return out;
}

}  // namespace

int serve(const ServeOptions& options) {
  server::ServerOptions server;
  server.address = options.address;
  server.port = static_cast<unsigned short>(options.port);
  server.root = options.page.empty() ? page_folder() : options.page;
  server.allowed_hosts = options.allowed_hosts;
  server.max_clients = options.clients;
  server.threads = int(std::clamp(std::thread::hardware_concurrency(), 2u, 8u));
  const std::vector<host::MenuScene> scenes = menu_scenes();
  const scene::Resolver files = server::shared_files(data_folders("scenes"), data_folders("presets"));
  if (options.tls) {
    core::Result<server::TlsIdentity> identity = options.certificate.empty()
                                                     ? server::user_identity(options.allowed_hosts)
                                                     : server::read_identity(options.certificate, options.key);
    if (!identity.ok()) return fail(exit_input, identity.error().message);
    server.tls = std::move(identity).value();
  }
  server.host_options = [&scenes, &files, threads = options.threads] {
    host::HostOptions out;
    out.threads = threads;
    out.scenes = scenes;
    out.parse_scene = [&files](std::string_view name,
                               std::string_view text) -> core::Result<std::unique_ptr<host::Demo>> {
      core::Result<scene::Scene> scene = scene::parse_scene(text, name, files);
      if (!scene.ok()) return scene.error();
      return host::make_scene_demo(std::move(scene).value(), std::string(name));
    };
    return out;
  };
  core::Result<std::unique_ptr<server::Server>> started = server::Server::start(server);
  // The usual port is often taken; only a port that somebody asked for is worth an error.
  for (int next = 1; !started.ok() && !options.port_given && next < 20; ++next) {
    server.port = static_cast<unsigned short>(options.port + next);
    started = server::Server::start(server);
  }
  if (!started.ok()) return fail(exit_system, started.error().message);
  const std::string url = (*started)->url();
  std::string fingerprint;
  if (server.tls)
    if (const core::Result<std::string> found = server::fingerprint(*server.tls); found.ok()) fingerprint = *found;
  if (options.json)
    std::printf("%s\n", nlohmann::json({{"url", url},
                                        {"port", (*started)->port()},
                                        {"page", server.root},
                                        {"scenes", scenes.size()},
                                        {"fingerprint", fingerprint}})
                            .dump()
                            .c_str());
  else if (!options.quiet)
    std::printf(
        "Carom is at %s   (Ctrl-C ends it)\n%s", url.c_str(),
        server.root.empty() ? "the page has not been built: ./play builds it; the WebSocket at /ws works\n" : "");
  if (!options.json && !options.quiet && options.address == "0.0.0.0")
    for (const std::string& address : network_addresses())
      std::printf("for other devices: %s://%s:%d/\n", server.tls ? "https" : "http", address.c_str(),
                  int((*started)->port()));
  if (!options.json && !options.quiet && !fingerprint.empty())
    std::printf("its certificate's SHA-256 is %s\n", fingerprint.c_str());
  std::fflush(stdout);
  watch_for_interrupts();
  if (options.open) open_browser(url);
  while (!interrupted) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  (*started)->stop();
  return exit_ok;
}

#else

int serve(const ServeOptions&) {
  return fail(exit_system, "this build has no server: install libboost-dev and build again");
}

#endif

}  // namespace carom::command
