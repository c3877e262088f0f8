# The JSON parser is headers only and private to this room.
find_path(CAROM_NLOHMANN_JSON_INCLUDE nlohmann/json.hpp HINTS /usr/include /usr/local/include NO_CMAKE_FIND_ROOT_PATH)
if(NOT CAROM_NLOHMANN_JSON_INCLUDE)
  message(FATAL_ERROR "Carom needs nlohmann-json (Debian and Ubuntu: nlohmann-json3-dev). "
    "Set CAROM_NLOHMANN_JSON_INCLUDE to the folder that has nlohmann/json.hpp.")
endif()
if(CMAKE_CROSSCOMPILING)
  # Only this library's folder may be seen, not the machine's other headers.
  file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/nlohmann_include)
  file(CREATE_LINK ${CAROM_NLOHMANN_JSON_INCLUDE}/nlohmann ${CMAKE_BINARY_DIR}/nlohmann_include/nlohmann SYMBOLIC)
  target_include_directories(${target} SYSTEM PRIVATE ${CMAKE_BINARY_DIR}/nlohmann_include)
elseif(NOT CAROM_NLOHMANN_JSON_INCLUDE STREQUAL "/usr/include")
  target_include_directories(${target} SYSTEM PRIVATE ${CAROM_NLOHMANN_JSON_INCLUDE})
endif()
