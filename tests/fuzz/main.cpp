// What libFuzzer calls: the target by whose name the program was called.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/fuzz/target.h"

namespace {
const carom::fuzz::Target* chosen = nullptr;
}

extern "C" int LLVMFuzzerInitialize(int*, char*** arguments) {
  std::string_view name = (*arguments)[0];
  name.remove_prefix(name.rfind('/') + 1);  // npos + 1 is 0
  for (const auto* target = carom::fuzz::Target::first; target; target = target->next)
    if (name.starts_with("fuzz_") && name.substr(5) == target->name) chosen = target;
  if (chosen) return 0;
  std::fprintf(stderr, "called as %.*s, expected to be called by the name of a target:", int(name.size()), name.data());
  for (const auto* target = carom::fuzz::Target::first; target; target = target->next)
    std::fprintf(stderr, " fuzz_%s", target->name);
  std::fputs("\n", stderr);
  std::exit(2);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  chosen->run(data, size);
  return 0;
}
