#include <cstdio>

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::string format(const char* pattern, double a, double b, double c, double d, double e, double f) {
  char buffer[256];
  std::snprintf(buffer, sizeof buffer, pattern, a, b, c, d, e, f);
  return buffer;
}

}  // namespace carom::host::demo
