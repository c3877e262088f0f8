// What a request may ask for: pure functions on text, so that a test can try every trick on them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace carom::server {

/// The file that a request target names under `root`, or nothing where it names none: a target that is not absolute,
/// holds "..", a NUL, a backslash or a bad percent escape, or leads outside through a link.
std::optional<std::filesystem::path> resolve_target(const std::filesystem::path& root, std::string_view target);

std::string_view content_type(const std::filesystem::path& path);

/// The name in a Host header or an origin's authority without its port; empty where it is malformed.
std::string_view host_name(std::string_view authority);
/// Loopback names and numbers always; any address given as a number where the server was told to listen beyond
/// loopback; and the names the user allowed. A foreign name is how a page elsewhere would reach in (DNS rebinding).
bool host_allowed(std::string_view authority, bool beyond_loopback, std::span<const std::string> allowed);
/// A page's origin must be the host it talks to; programs send none.
bool origin_allowed(std::string_view origin, std::string_view authority);

}  // namespace carom::server
