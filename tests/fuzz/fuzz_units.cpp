// Quantities from anybody: a finite value that survives being written and read, or a clear error.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>

#include "carom/math/decimal.h"
#include "carom/math/quantity.h"
#include "tests/fuzz/target.h"

namespace {

[[noreturn]] void broken(const char* what, std::string_view text) {
  std::fprintf(stderr, "%s: \"%.*s\"\n", what, int(text.size()), text.data());
  std::abort();
}

void check_decimal(std::string_view text) {
  using namespace carom::math;
  const DecimalResult number = parse_decimal(text);
  if (number.length > text.size()) broken("more characters used than there are", text);
  if (number.length == 0) return;
  // What was used is a number by itself, and the same one.
  const DecimalResult again = parse_decimal(text.substr(0, number.length));
  if (again.length != number.length || again.value != number.value) broken("the number is another by itself", text);
  if (number.value - number.value != 0) return;  // overflow
  const std::string written = format_decimal(number.value);
  if (parse_decimal(written).value != number.value) broken("the shortest text is another number", written);
}

void check_quantity(std::string_view text, std::string_view unit) {
  using namespace carom::math;
  const QuantityResult found = parse_quantity(text);
  if (!found.ok) {
    if (found.error.empty()) broken("an error without a message", text);
    return;
  }
  if (found.si - found.si != 0) broken("neither finite nor an error", text);
  const QuantityResult same = parse_quantity(text, found.dimension);
  if (!same.ok || same.si != found.si) broken("its own dimension is refused", text);
  // The bare number is exact; in any other unit of the dimension it is so within a few ulp.
  const QuantityResult bare = parse_quantity(format_quantity(found.si, ""));
  if (!bare.ok || bare.si != found.si) broken("the bare number is another", text);
  const std::string written = format_quantity(found.si, unit);
  if (written.empty()) return;
  const QuantityResult again = parse_quantity(written);
  if (!again.ok) return;  // the value has no finite expression in that unit
  const double size = found.si < 0 ? -found.si : found.si;
  const double error = again.si < found.si ? found.si - again.si : again.si - found.si;
  const bool offset = again.dimension == dimensions::temperature;  // degC and degF begin at 273.15 K and 255.37 K
  if (size > 1e-280 && error > 1e-14 * (size + (offset ? 300 : 0))) broken("written and read it is another", written);
  (void)format_quantity(found.si, unit, 3);
  (void)convert(found.si, unit, "kg");
}

}  // namespace

FUZZ_TARGET(units) {
  if (size > 4096) return;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const std::size_t line = text.find('\n');
  const std::string_view first = text.substr(0, line);
  const std::string_view second = line == std::string_view::npos ? std::string_view("m") : text.substr(line + 1);
  check_decimal(first);
  check_quantity(first, second);
}
