# SPDX-License-Identifier: Apache-2.0
# The page that shows meshes and fields (view/page) as a part of the library: its scripts become one, and the policy that the
# page carries names the hashes of what may run.
file(GLOB STANDOFF_PAGE_FILES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/view/page/*)
set(STANDOFF_PAGE_DIR ${CMAKE_CURRENT_BINARY_DIR}/embedded)
add_custom_command(
  OUTPUT ${STANDOFF_PAGE_DIR}/kPageHtml.cpp ${STANDOFF_PAGE_DIR}/kPageStyle.cpp ${STANDOFF_PAGE_DIR}/kPageScript.cpp ${STANDOFF_PAGE_DIR}/kPageHashes.cpp
  COMMAND ${CMAKE_COMMAND} -DFOLDER=${PROJECT_SOURCE_DIR}/view/page -DOUTPUT=${STANDOFF_PAGE_DIR} -P ${PROJECT_SOURCE_DIR}/cmake/bundle_page.cmake
  DEPENDS ${STANDOFF_PAGE_FILES} ${PROJECT_SOURCE_DIR}/cmake/bundle_page.cmake ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
  COMMENT "Embedding view/page" VERBATIM)
target_sources(standoff_page PRIVATE ${STANDOFF_PAGE_DIR}/kPageHtml.cpp ${STANDOFF_PAGE_DIR}/kPageStyle.cpp
               ${STANDOFF_PAGE_DIR}/kPageScript.cpp ${STANDOFF_PAGE_DIR}/kPageHashes.cpp)
