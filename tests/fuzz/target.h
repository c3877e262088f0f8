// What looks for inputs that break something: FUZZ_TARGET(hull) { … data, size … }. Linking takes long, so that one
// program holds many; it is called by their names, fuzz_hull.
#pragma once

#include <cstddef>
#include <cstdint>

namespace carom::fuzz {

struct Target {
  using Run = void (*)(const std::uint8_t* data, std::size_t size);
  Target(const char* its_name, Run its_run) : name(its_name), run(its_run), next(first) { first = this; }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;

  const char* name;
  Run run;
  const Target* next;
  static inline const Target* first = nullptr;
};

}  // namespace carom::fuzz

#define FUZZ_TARGET(NAME)                                              \
  static void fuzz_##NAME(const std::uint8_t* data, std::size_t size); \
  static const carom::fuzz::Target target_##NAME(#NAME, fuzz_##NAME);  \
  static void fuzz_##NAME(const std::uint8_t* data, std::size_t size)
