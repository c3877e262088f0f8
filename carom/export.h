// CAROM_API marks what a shared build of Carom exports; everything else has hidden visibility.
#pragma once

#if defined(CAROM_SHARED) && (defined(__GNUC__) || defined(__clang__))
#define CAROM_API __attribute__((visibility("default")))
#else
#define CAROM_API
#endif
