# carom_add_room(NAME FLOOR): compiles carom/NAME as the object library carom_NAME (no exceptions, no RTTI, hidden
# visibility) and, where tests are built, tests/NAME as the program test_NAME, linked only to the rooms at or below
# its floor. Sources named *_avx2.cpp and *_avx512.cpp are compiled for those instruction sets.
set_property(GLOBAL PROPERTY CAROM_ROOMS "")

function(carom_add_room NAME FLOOR)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/carom/${NAME}/*.cpp)
  if(NOT sources)
    return()
  endif()
  set(target carom_${NAME})
  add_library(${target} OBJECT ${sources})
  target_link_libraries(${target} PUBLIC carom_flags)
  target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti)
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON UNITY_BUILD ${CAROM_UNITY} UNITY_BUILD_BATCH_SIZE ${CAROM_UNITY_BATCH})
  if(BUILD_SHARED_LIBS)
    target_compile_definitions(${target} PUBLIC CAROM_SHARED)
  endif()
  foreach(source IN LISTS sources)
    if(source MATCHES "_avx2\\.cpp$")
      set(flags -mavx2)
    elseif(source MATCHES "_avx512\\.cpp$")
      set(flags -mavx512f -mavx512vl -mavx512dq -mavx512bw -mprefer-vector-width=512
        -fno-tree-slp-vectorize)  # gcc 12 fuses a·b ± c in this pass in spite of -ffp-contract=off
    else()
      continue()
    endif()
    if(CAROM_WIDE AND CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
      set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "${flags}" SKIP_UNITY_BUILD_INCLUSION ON)
    else()
      set_source_files_properties(${source} PROPERTIES HEADER_FILE_ONLY ON)
    endif()
  endforeach()
  if(EXISTS ${PROJECT_SOURCE_DIR}/carom/${NAME}/room.cmake)
    include(${PROJECT_SOURCE_DIR}/carom/${NAME}/room.cmake)  # what this room needs beyond the rule
  endif()
  set_property(GLOBAL APPEND PROPERTY CAROM_ROOMS ${NAME})
  set_property(GLOBAL PROPERTY CAROM_FLOOR_OF_${NAME} ${FLOOR})
endfunction()

# The object libraries of all rooms on a floor at or below FLOOR.
function(carom_rooms_below FLOOR OUT)
  get_property(rooms GLOBAL PROPERTY CAROM_ROOMS)
  set(result "")
  foreach(room IN LISTS rooms)
    get_property(floor GLOBAL PROPERTY CAROM_FLOOR_OF_${room})
    if(floor LESS_EQUAL FLOOR)
      list(APPEND result carom_${room})
    endif()
  endforeach()
  set(${OUT} ${result} PARENT_SCOPE)
endfunction()

# carom_compile_lightly(TARGET): for what no one waits for when it runs. In an optimised build its sources are compiled
# with less of it, which takes half the time; results are the same, as everywhere. For WebAssembly all is compiled for
# size: the page's visitors download it.
function(carom_compile_lightly TARGET)
  if(NOT CMAKE_SYSTEM_NAME STREQUAL "WASI")
    target_compile_options(${TARGET} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
endfunction()

# carom_add_test(NAME FLOOR [folder]): all of tests/NAME as one program, linked to the rooms up to FLOOR.
function(carom_add_test NAME FLOOR)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${NAME}/*.cpp)
  if(NOT sources)
    return()
  endif()
  carom_rooms_below(${FLOOR} rooms)
  add_executable(test_${NAME} ${sources})
  # The assertions of GoogleTest are written with an else of their own: `if (x) EXPECT_EQ(a, b);` is no mistake. What
  # assertions would clean up if something threw takes an eighth of their time to compile, and no test catches anything.
  target_compile_options(test_${NAME} PRIVATE -fno-exceptions $<$<CXX_COMPILER_ID:GNU>:-Wno-dangling-else>)
  # With -O1 assertions take half as long again to compile. Rooms come before their tests at the link, so their own
  # inline functions stay as fast as they are. Some tests compute much themselves.
  if(NAME MATCHES "^(math|geometry|particles|ballistics|blast)$")
    carom_compile_lightly(test_${NAME})
  else()
    target_compile_options(test_${NAME} PRIVATE $<$<CONFIG:Release>:-O0>)
  endif()
  target_link_libraries(test_${NAME} PRIVATE ${rooms} carom_flags GTest::gtest_main Threads::Threads ${ARGN})
  set_target_properties(test_${NAME} PROPERTIES UNITY_BUILD ${CAROM_UNITY} UNITY_BUILD_BATCH_SIZE ${CAROM_UNITY_BATCH})
  target_compile_definitions(test_${NAME} PRIVATE CAROM_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  add_test(NAME ${NAME} COMMAND test_${NAME} --gtest_brief=1)
endfunction()

# The library itself: every room in one archive or shared object.
function(carom_add_library)
  get_property(rooms GLOBAL PROPERTY CAROM_ROOMS)
  add_library(carom)
  foreach(room IN LISTS rooms)
    target_sources(carom PRIVATE $<TARGET_OBJECTS:carom_${room}>)
    get_target_property(libraries carom_${room} CAROM_PRIVATE_LIBRARIES)
    if(libraries)
      target_link_libraries(carom PRIVATE ${libraries})
    endif()
  endforeach()
  add_library(carom::carom ALIAS carom)
  target_compile_features(carom PUBLIC cxx_std_20)
  # The inline functions of the headers must give a user who compiles with -march=native the library's own bits.
  target_compile_options(carom INTERFACE $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-ffp-contract=off>)
  target_include_directories(carom PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include>)
  set_target_properties(carom PROPERTIES LINKER_LANGUAGE CXX VERSION ${PROJECT_VERSION} SOVERSION 0)
  if(BUILD_SHARED_LIBS)
    target_compile_definitions(carom PUBLIC CAROM_SHARED)
  endif()
  if(Threads_FOUND AND NOT CMAKE_SYSTEM_NAME STREQUAL "WASI")
    target_link_libraries(carom PUBLIC Threads::Threads)
  endif()
endfunction()

# All rooms as one translation unit, which is read and never built: a tool that goes through it meets each header once.
function(carom_add_single_unit NAME)
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/carom/*.cpp)
  list(FILTER sources EXCLUDE REGEX "_avx(2|512)\\.cpp$")
  add_library(${NAME} OBJECT EXCLUDE_FROM_ALL ${sources})
  target_link_libraries(${NAME} PRIVATE carom_flags)
  target_compile_options(${NAME} PRIVATE -fno-exceptions -fno-rtti)
  set_target_properties(${NAME} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)
endfunction()
