// Inline wherever it is called, in loops that must be fast; a call where a small file counts more (WebAssembly).
#pragma once

#ifdef __wasm__
#define CAROM_HOT_INLINE inline
#else
#define CAROM_HOT_INLINE [[gnu::always_inline]] inline
#endif
