# Installation: headers, the library, a CMake package and a pkg-config file; and the same target from the build tree.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS carom EXPORT carom-targets
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/carom/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/carom
  FILES_MATCHING PATTERN "*.h")
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/carom)
install(EXPORT carom-targets NAMESPACE carom:: FILE carom-targets.cmake DESTINATION ${package_dir})
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/carom-config.cmake.in
  ${PROJECT_BINARY_DIR}/carom-config.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/carom-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/carom-config.cmake ${PROJECT_BINARY_DIR}/carom-config-version.cmake
  DESTINATION ${package_dir})

# find_package(carom) with carom_DIR set to the build folder.
export(EXPORT carom-targets NAMESPACE carom:: FILE ${PROJECT_BINARY_DIR}/carom-targets.cmake)

# The pkg-config file finds its prefix from its own place, so that an installation may be moved.
file(RELATIVE_PATH CAROM_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" CAROM_PC_PREFIX "${CAROM_PC_PREFIX}")
set(CAROM_PC_FLAGS -ffp-contract=off)
if(BUILD_SHARED_LIBS)
  string(APPEND CAROM_PC_FLAGS " -DCAROM_SHARED")
endif()
configure_file(${PROJECT_SOURCE_DIR}/cmake/carom.pc.in ${PROJECT_BINARY_DIR}/carom.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/carom.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
