#include "apps/server/requests.h"

#include <algorithm>
#include <system_error>

namespace carom::server {

namespace fs = std::filesystem;

namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> unescape(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out.push_back(text[i]);
      continue;
    }
    if (i + 2 >= text.size()) return {};
    const int high = hex_digit(text[i + 1]), low = hex_digit(text[i + 2]);
    if (high < 0 || low < 0) return {};
    out.push_back(char(high * 16 + low));
    i += 2;
  }
  return out;
}

bool is_number_address(std::string_view name) {
  if (name.find(':') != std::string_view::npos)
    return name.find_first_not_of("0123456789abcdefABCDEF:.") == std::string_view::npos;
  return !name.empty() && name.find_first_not_of("0123456789.") == std::string_view::npos;
}

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return out;
}

}  // namespace

std::optional<fs::path> resolve_target(const fs::path& root, std::string_view target) {
  target = target.substr(0, target.find_first_of("?#"));
  if (target.empty() || target.front() != '/' || target.size() > 2048) return {};
  const std::optional<std::string> path = unescape(target);
  if (!path) return {};
  for (const char c : *path)
    if (static_cast<unsigned char>(c) < 0x20 || c == '\\' || c == 0x7f) return {};
  const fs::path relative = fs::path(
      path->substr(path->find_first_not_of('/') == std::string::npos ? path->size() : path->find_first_not_of('/')));
  for (const fs::path& part : relative) {
    const std::string name = part.string();
    if (name == ".." || name == "." || (!name.empty() && name.front() == '.')) return {};
  }
  std::error_code error;
  const fs::path base = fs::canonical(root, error);
  if (error) return {};
  fs::path found = fs::weakly_canonical(base / relative, error);
  if (error) return {};
  if (fs::is_directory(found, error)) found /= "index.html";
  if (!fs::is_regular_file(found, error)) return {};
  found = fs::canonical(found, error);
  if (error) return {};
  const auto mismatch = std::mismatch(base.begin(), base.end(), found.begin(), found.end());
  if (mismatch.first != base.end()) return {};
  return found;
}

std::string_view content_type(const fs::path& path) {
  struct Type {
    std::string_view extension, type;
  };
  static constexpr Type types[] = {
      {".html", "text/html; charset=utf-8"},
      {".js", "text/javascript; charset=utf-8"},
      {".mjs", "text/javascript; charset=utf-8"},
      {".css", "text/css; charset=utf-8"},
      {".json", "application/json"},
      {".map", "application/json"},
      {".svg", "image/svg+xml"},
      {".png", "image/png"},
      {".jpg", "image/jpeg"},
      {".webp", "image/webp"},
      {".ico", "image/x-icon"},
      {".wasm", "application/wasm"},
      {".woff2", "font/woff2"},
      {".txt", "text/plain; charset=utf-8"},
      {".md", "text/plain; charset=utf-8"},
      {".webmanifest", "application/manifest+json"},
      {".glb", "model/gltf-binary"},
      {".hdr", "application/octet-stream"},
  };
  const std::string extension = lower(path.extension().string());
  for (const Type& type : types)
    if (extension == type.extension) return type.type;
  return "application/octet-stream";
}

std::string_view host_name(std::string_view authority) {
  if (authority.empty() || authority.size() > 255) return {};
  std::string_view name, rest;
  if (authority.front() == '[') {
    const std::size_t end = authority.find(']');
    if (end == std::string_view::npos) return {};
    name = authority.substr(1, end - 1);
    rest = authority.substr(end + 1);
  } else {
    const std::size_t colon = authority.find(':');
    name = authority.substr(0, colon);
    rest = colon == std::string_view::npos ? std::string_view{} : authority.substr(colon);
  }
  if (!rest.empty() && (rest.front() != ':' || rest.size() > 6 ||
                        rest.substr(1).find_first_not_of("0123456789") != std::string_view::npos))
    return {};
  return name;
}

bool host_allowed(std::string_view authority, bool beyond_loopback, std::span<const std::string> allowed) {
  const std::string name = lower(host_name(authority));
  if (name.empty()) return false;
  if (name == "localhost" || name == "127.0.0.1" || name == "::1") return true;
  if (beyond_loopback && is_number_address(name)) return true;
  return std::any_of(allowed.begin(), allowed.end(), [&](const std::string& one) { return lower(one) == name; });
}

bool origin_allowed(std::string_view origin, std::string_view authority) {
  if (origin.empty()) return true;
  for (const std::string_view scheme : {"http://", "https://"})
    if (origin.substr(0, scheme.size()) == scheme) return lower(origin.substr(scheme.size())) == lower(authority);
  return false;
}

}  // namespace carom::server
