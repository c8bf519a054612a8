# SPDX-License-Identifier: Apache-2.0
# A port of vcpkg: `vcpkg install standoff --overlay-ports=packaging/vcpkg`. It builds the sources that it lies in; in
# vcpkg's own registry vcpkg_from_github takes that line's place. packaging/README.md says what of it is checked.
get_filename_component(SOURCE_PATH "${CMAKE_CURRENT_LIST_DIR}/../.." ABSOLUTE)

vcpkg_check_features(OUT_FEATURE_OPTIONS feature_options
  FEATURES
    blosc   STANDOFF_WITH_BLOSC
    cuda    STANDOFF_WITH_CUDA
    meshopt STANDOFF_WITH_MESHOPT
    png     STANDOFF_WITH_PNG
    tools   STANDOFF_BUILD_CLI
    tools   STANDOFF_BUILD_SCENES
)
vcpkg_cmake_configure(
  SOURCE_PATH "${SOURCE_PATH}"
  OPTIONS
    ${feature_options}
    -DSTANDOFF_BUILD_TESTS=OFF
    -DCMAKE_DISABLE_FIND_PACKAGE_boost_context=ON  # or what happens to be installed would decide
)
vcpkg_cmake_install()
vcpkg_cmake_config_fixup(CONFIG_PATH lib/cmake/standoff)
if("tools" IN_LIST FEATURES)
  vcpkg_copy_tools(TOOL_NAMES standoff AUTO_CLEAN)
endif()
file(REMOVE_RECURSE "${CURRENT_PACKAGES_DIR}/debug/include" "${CURRENT_PACKAGES_DIR}/debug/share"
                    "${CURRENT_PACKAGES_DIR}/share/doc")
vcpkg_install_copyright(FILE_LIST "${SOURCE_PATH}/LICENSE" "${SOURCE_PATH}/src/render/font/OFL.txt")
