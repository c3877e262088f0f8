# WebAssembly by clang and wasi-libc (Debian: clang-19, lld-19, wasi-libc, libc++-19-dev-wasm32, libclang-rt-19-dev-wasm32).
# SIMD128, atomics, no exceptions: the same sources and the same bits as the native build.
set(CMAKE_SYSTEM_NAME WASI)
set(CMAKE_SYSTEM_VERSION 1)
set(CMAKE_SYSTEM_PROCESSOR wasm32)
set(UNIX TRUE)
find_program(CAROM_WASM_CC NAMES clang-20 clang-19 clang-18 clang-17 clang REQUIRED)
find_program(CAROM_WASM_CXX NAMES clang++-20 clang++-19 clang++-18 clang++-17 clang++ REQUIRED)
set(CMAKE_C_COMPILER ${CAROM_WASM_CC})
set(CMAKE_CXX_COMPILER ${CAROM_WASM_CXX})
set(CMAKE_C_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_COMPILER_TARGET wasm32-wasi)
set(CMAKE_CXX_FLAGS_INIT "-msimd128 -fno-exceptions -fno-rtti -D_WASI_EMULATED_PROCESS_CLOCKS")
# Several instances may run on one memory (apps/wasm/runtime.cpp).
add_compile_options(-matomics -mbulk-memory -include ${CMAKE_CURRENT_LIST_DIR}/wasm_errno.h)
# A megabyte of stack: blocks of a thousand particles lie on it; the default of 64 KiB is overrun without a word.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-lwasi-emulated-process-clocks -Wl,-z,stack-size=1048576")
# Optimised when it is linked, so the archives hold clang's own form of code, which an older llvm-ar cannot read: the
# plain ar does not look, and the linker needs no index.
find_program(CAROM_WASM_AR NAMES ar REQUIRED)
set(CMAKE_AR ${CAROM_WASM_AR})
set(CMAKE_CXX_COMPILER_AR ${CAROM_WASM_AR})
set(CMAKE_RANLIB true)
set(CMAKE_CXX_COMPILER_RANLIB true)
set(CMAKE_TRY_COMPILE_TARGET_TYPE STATIC_LIBRARY)
# (CMake resets the one without a language for a system that it does not know.)
set(CMAKE_EXECUTABLE_SUFFIX_C .wasm)
set(CMAKE_EXECUTABLE_SUFFIX_CXX .wasm)
