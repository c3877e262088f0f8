// Included before everything else for WebAssembly: wasi-libc was built for one thread and has one `errno` for all; its
// header would have every thread look for its own.
#pragma once
#define __wasilibc___errno_h
#ifdef __cplusplus
extern "C" {
#endif
extern int errno;
#ifdef __cplusplus
}
#endif
#define errno errno
