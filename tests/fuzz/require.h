// What a fuzz target holds true of every input: a crash with a reason is what the fuzzer looks for.
#pragma once

#include <cstdio>
#include <cstdlib>

inline void require(bool true_of_all, const char* what) {
  if (true_of_all) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}
