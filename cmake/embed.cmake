# SPDX-License-Identifier: Apache-2.0
# Files that become part of the library or of a program: a font, a page.

# standoff_embed(TARGET SYMBOL FILE): the target's `extern const std::string_view standoff::SYMBOL`, which its sources declare
# themselves, holds the bytes of FILE (a path below the source folder). Built again when FILE changes. A byte takes seven of the
# generated source: meant for some hundred kilobytes. An empty file is an error.
function(standoff_embed target symbol file)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/embedded/${symbol}.cpp)
  add_custom_command(
    OUTPUT ${source}
    COMMAND ${CMAKE_COMMAND} -DSYMBOL=${symbol} -DFILE=${PROJECT_SOURCE_DIR}/${file} -DOUTPUT=${source} -P ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    DEPENDS ${PROJECT_SOURCE_DIR}/${file} ${PROJECT_SOURCE_DIR}/cmake/embed_file.cmake
    COMMENT "Embedding ${file}" VERBATIM)
  target_sources(${target} PRIVATE ${source})
endfunction()
