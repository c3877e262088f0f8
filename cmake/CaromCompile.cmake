# One target that carries the compile flags of everything in this repository.
add_library(carom_flags INTERFACE)
target_compile_features(carom_flags INTERFACE cxx_std_20)
# Bit-equal results on every compiler need strict IEEE arithmetic: no contraction to fused multiply-add and no
# reassociation. No one reads errno or floating-point traps, so square roots may be single instructions.
target_compile_options(carom_flags INTERFACE
  -ffp-contract=off -fno-math-errno -fno-trapping-math
  -Wall -Wextra -Wpedantic -Wno-psabi $<$<BOOL:${CAROM_WERROR}>:-Werror>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized -Wno-misleading-indentation -Wno-restrict -Wno-free-nonheap-object>
  $<$<CXX_COMPILER_ID:Clang>:-Wno-unknown-warning-option -Wno-missing-field-initializers -Wno-gnu-anonymous-struct -Wno-nested-anon-types>
  $<$<CXX_COMPILER_ID:GNU>:-Wno-missing-field-initializers>
  # In unity a source is an included file, where gcc distrusts anonymous namespaces as if it were a header. Its units are
  # large: gcc collects garbage from 1 GiB on instead of from 128 MiB, which saves a seventh of the time and takes 1.3
  # times the memory.
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CAROM_UNITY}>>:-Wno-subobject-linkage --param=ggc-min-heapsize=1048576>)
# gcc 12 turns neighbouring a·b − c, a·b + c into one fused instruction in its straight-line vectoriser even with
# -ffp-contract=off. Only where the target has such instructions (a user's -march=native, say).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  include(CheckCXXSourceCompiles)
  check_cxx_source_compiles("#if !defined(__FMA__) && !defined(__AVX512F__)\n#error none\n#endif\nint main() {}"
    CAROM_TARGET_FUSES)
  if(CAROM_TARGET_FUSES)
    target_compile_options(carom_flags INTERFACE -fno-tree-slp-vectorize)
  endif()
endif()
# A build by profile, in one build folder: `record`, build, run what is to be fast, `use`, build again (docs/benchmarks.md).
# What is laid out and inlined changes, not what is computed.
set(CAROM_PROFILE "" CACHE STRING "record: the program counts what it runs; use: optimise by what was counted (gcc)")
if(CAROM_PROFILE)
  if(NOT CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    message(FATAL_ERROR "CAROM_PROFILE needs gcc; the compiler is ${CMAKE_CXX_COMPILER_ID}")
  elseif(CAROM_PROFILE STREQUAL "record")
    target_compile_options(carom_flags INTERFACE -fprofile-generate -fprofile-update=prefer-atomic)
    target_link_options(carom_flags INTERFACE -fprofile-generate)
  elseif(CAROM_PROFILE STREQUAL "use")
    target_compile_options(carom_flags INTERFACE -fprofile-use -fprofile-partial-training -Wno-missing-profile)
  else()
    message(FATAL_ERROR "CAROM_PROFILE is '${CAROM_PROFILE}', expected record, use or nothing")
  endif()
endif()
target_compile_definitions(carom_flags INTERFACE $<$<NOT:$<BOOL:${CAROM_WIDE}>>:CAROM_BASELINE_ONLY>)
target_include_directories(carom_flags INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
find_package(Threads)
