# Install rules and the package files of find_package(difi).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(DIFI_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/difi)

# A static library leaves its private dependencies to be linked by its users, who must find them first.
set(DIFI_FIND_DEPENDENCIES "")
if(NOT BUILD_SHARED_LIBS)
  foreach(dependency IN LISTS DIFI_LINKED_PACKAGES)
    string(APPEND DIFI_FIND_DEPENDENCIES "find_dependency(${dependency})\n")
  endforeach()
endif()
configure_package_config_file(cmake/difi-config.cmake.in difi-config.cmake INSTALL_DESTINATION ${DIFI_PACKAGE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(difi-config-version.cmake COMPATIBILITY SameMinorVersion)

install(TARGETS difi EXPORT difi-targets)
install(DIRECTORY include/difi TYPE INCLUDE)
install(EXPORT difi-targets NAMESPACE difi:: DESTINATION ${DIFI_PACKAGE_DIR})
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/difi-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/difi-config-version.cmake
        DESTINATION ${DIFI_PACKAGE_DIR})
install(FILES LICENSE TYPE DOC)
if(DIFI_BUILD_CLI)
  install(TARGETS difi_cli)
endif()
