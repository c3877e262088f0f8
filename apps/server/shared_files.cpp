#include "apps/server/shared_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

namespace carom::server {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t max_bytes = 16u << 20;

/// The file `name` of a folder, where it lies within.
fs::path inside(const std::string& folder, std::string_view name) {
  std::error_code error;
  const fs::path root = fs::canonical(folder, error);
  if (error) return {};
  const fs::path found = fs::canonical(root / name, error);
  if (error || !fs::is_regular_file(found, error)) return {};
  const auto differ = std::mismatch(root.begin(), root.end(), found.begin(), found.end());
  return differ.first == root.end() ? found : fs::path();
}

}  // namespace

scene::Resolver shared_files(std::vector<std::string> scenes, std::vector<std::string> presets) {
  return
      [scenes = std::move(scenes), presets = std::move(presets)](std::string_view name) -> core::Result<std::string> {
        constexpr std::string_view prefix = "presets/";
        const bool preset = name.substr(0, prefix.size()) == prefix;
        const std::string_view file = preset ? name.substr(prefix.size()) : name;
        for (const std::string& folder : preset ? presets : scenes) {
          const fs::path found = inside(folder, file);
          std::error_code error;
          if (found.empty() || fs::file_size(found, error) > max_bytes || error) continue;
          std::ifstream in(found, std::ios::binary);
          std::string text{std::istreambuf_iterator<char>(in), {}};
          if (!in.bad() && in.is_open()) return text;
        }
        return core::Error{std::string(name) + ": expected a file of at most 16 MiB in the folder of " +
                           (preset ? "presets" : "scenes")};
      };
}

}  // namespace carom::server
