# SPDX-License-Identifier: Apache-2.0
# Debian packages: `cpack` in a build folder, or script/deb. standoff holds the program, libstandoff-dev all that
# find_package(standoff) needs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME standoff)
set(CPACK_PACKAGE_CONTACT "the authors of standoff <standoff@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}, and collision queries")
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL dev)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

if(STANDOFF_BUILD_CLI)
  list(APPEND CPACK_COMPONENTS_ALL program)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME standoff)
  set(CPACK_DEBIAN_PROGRAM_PACKAGE_SHLIBDEPS ON)  # by dpkg-shlibdeps, out of what the program is linked with
  set(CPACK_COMPONENT_PROGRAM_DESCRIPTION
      "Computes signed distance fields of triangle meshes, exactly, and answers collision queries.\nThis package holds the program.")
endif()

# What a static library's users must have: the packages that its find_package file looks for.
set(STANDOFF_DEBIAN_Threads libc6-dev)
set(STANDOFF_DEBIAN_TBB libtbb-dev)
set(STANDOFF_DEBIAN_ZLIB zlib1g-dev)
set(STANDOFF_DEBIAN_Blosc libblosc-dev)
set(STANDOFF_DEBIAN_PNG libpng-dev)
set(STANDOFF_DEBIAN_meshoptimizer libmeshoptimizer-dev)
set(STANDOFF_DEBIAN_boost_context libboost-context-dev)
set(STANDOFF_DEBIAN_CUDAToolkit "")  # no package has it; its runtime comes with the library (cmake/install.cmake)
set(needed "")
foreach(package IN LISTS STANDOFF_LINKED_PACKAGES)
  if(NOT DEFINED STANDOFF_DEBIAN_${package})
    message(FATAL_ERROR "cmake/package.cmake: which Debian package is ${package}? Name it in this file")
  endif()
  list(APPEND needed ${STANDOFF_DEBIAN_${package}})
endforeach()
list(JOIN needed ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libstandoff-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_COMPONENT_DEV_DESCRIPTION
    "Computes signed distance fields of triangle meshes, exactly, and answers collision queries.\nThis package holds the static library, its headers, and the files of CMake.")
include(CPack)
