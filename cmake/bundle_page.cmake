# SPDX-License-Identifier: Apache-2.0
# cmake -DFOLDER=view/page -DOUTPUT=FOLDER -P bundle_page.cmake: the page's template, style, script and hashes as C++.
#
# The scripts are ES modules, which editors understand and browsers do not load from a single file. Here each becomes a function
# that is called once and returns what it exports, in the order of scripts.txt: a file stands after those it imports from.
file(STRINGS ${FOLDER}/scripts.txt names)
set(script "const modules = {};\n")
foreach(name IN LISTS names)
  file(READ ${FOLDER}/${name} text)
  string(PREPEND text "\n")
  string(REGEX MATCHALL "\nexport (async )?(const|function|class) [A-Za-z0-9_]+" exports "${text}")
  list(TRANSFORM exports REPLACE ".* " "")
  list(JOIN exports ", " exports)
  string(REGEX REPLACE "\nimport ([^;]*) from ([^;]*);" "\nconst \\1 = modules[\\2];" text "${text}")
  string(REGEX REPLACE "\nexport " "\n" text "${text}")
  string(REGEX REPLACE "\n *//[^\n]*" "" text "${text}")
  string(APPEND script "modules['./${name}'] = (() => {${text}return {${exports}};\n})();\n")
endforeach()
file(WRITE ${OUTPUT}/page.js "(() => {\n'use strict';\n${script}})();\n")
configure_file(${FOLDER}/page.html ${OUTPUT}/page.html COPYONLY)
file(READ ${FOLDER}/page.css style)
string(REGEX REPLACE "\n *" "\n" style "${style}")
file(WRITE ${OUTPUT}/page.css "${style}")
file(SHA256 ${OUTPUT}/page.css style_hash)
file(SHA256 ${OUTPUT}/page.js script_hash)
file(WRITE ${OUTPUT}/hashes "${style_hash}\n${script_hash}\n")
foreach(part IN ITEMS Html:page.html Style:page.css Script:page.js Hashes:hashes)
  string(REGEX REPLACE "(.*):(.*)" "kPage\\1" SYMBOL ${part})
  string(REGEX REPLACE "(.*):(.*)" "${OUTPUT}/\\2" FILE ${part})
  set(source ${OUTPUT}/${SYMBOL}.cpp)
  execute_process(COMMAND ${CMAKE_COMMAND} -DSYMBOL=${SYMBOL} -DFILE=${FILE} -DOUTPUT=${source}
                  -P ${CMAKE_CURRENT_LIST_DIR}/embed_file.cmake COMMAND_ERROR_IS_FATAL ANY)
endforeach()
