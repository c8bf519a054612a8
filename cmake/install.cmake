# SPDX-License-Identifier: Apache-2.0
# Install rules and the package files of find_package(standoff).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)
set(STANDOFF_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/standoff)

# A static library leaves its private dependencies to be linked by its users, who must find them first.
set(STANDOFF_FIND_DEPENDENCIES "")
if(NOT BUILD_SHARED_LIBS)
  foreach(dependency IN LISTS STANDOFF_LINKED_PACKAGES)
    if(NOT dependency STREQUAL "CUDAToolkit")
      string(APPEND STANDOFF_FIND_DEPENDENCIES "find_dependency(${dependency})\n")
    endif()
  endforeach()
  # The kernels need the CUDA runtime they were compiled with, and their users need no toolkit: it comes along.
  if(STANDOFF_HAVE_CUDA)
    get_target_property(cudart CUDA::cudart_static IMPORTED_LOCATION)
    install(FILES ${cudart} DESTINATION ${CMAKE_INSTALL_LIBDIR}/standoff COMPONENT dev)
    configure_file(cmake/cuda_runtime.cmake.in cuda_runtime.cmake @ONLY)
    install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cuda_runtime.cmake DESTINATION ${STANDOFF_PACKAGE_DIR} COMPONENT dev)
    string(APPEND STANDOFF_FIND_DEPENDENCIES "include(\"\${CMAKE_CURRENT_LIST_DIR}/cuda_runtime.cmake\")\n")
  endif()
endif()
# find_package(standoff COMPONENTS ...) knows what this build holds.
set(STANDOFF_FOUND_COMPONENTS field ${STANDOFF_COMPONENTS})
configure_package_config_file(cmake/standoff-config.cmake.in standoff-config.cmake INSTALL_DESTINATION ${STANDOFF_PACKAGE_DIR})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(standoff-config-version.cmake COMPATIBILITY SameMinorVersion)

install(TARGETS standoff EXPORT standoff-targets COMPONENT dev)
install(DIRECTORY include/standoff TYPE INCLUDE COMPONENT dev)
install(EXPORT standoff-targets NAMESPACE standoff:: DESTINATION ${STANDOFF_PACKAGE_DIR} COMPONENT dev)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/standoff-config.cmake ${CMAKE_CURRENT_BINARY_DIR}/standoff-config-version.cmake
        DESTINATION ${STANDOFF_PACKAGE_DIR} COMPONENT dev)
if("Blosc" IN_LIST STANDOFF_LINKED_PACKAGES)
  install(FILES cmake/FindBlosc.cmake DESTINATION ${STANDOFF_PACKAGE_DIR} COMPONENT dev)
endif()
# The second is of the font that pictures are written with.
set(STANDOFF_LICENCES LICENSE src/render/font/OFL.txt)
install(FILES ${STANDOFF_LICENCES} TYPE DOC COMPONENT program)
install(FILES ${STANDOFF_LICENCES} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libstandoff-dev COMPONENT dev)
if(STANDOFF_BUILD_CLI)
  install(TARGETS standoff_cli COMPONENT program)
  if(STANDOFF_MANUAL_FOLDER)
    install(DIRECTORY ${STANDOFF_MANUAL_FOLDER}/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT program)
    install(FILES ${STANDOFF_MANUAL_FOLDER}/bash/standoff DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
            COMPONENT program)
    install(FILES ${STANDOFF_MANUAL_FOLDER}/fish/standoff.fish DESTINATION ${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d
            COMPONENT program)
    # Debian's zsh looks in the second one below /usr, all others in the first.
    foreach(folder IN ITEMS site-functions vendor-completions)
      install(FILES ${STANDOFF_MANUAL_FOLDER}/zsh/_standoff DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/${folder}
              COMPONENT program)
    endforeach()
  endif()
endif()
if(STANDOFF_TOP_LEVEL)
  include(cmake/package.cmake)
endif()
