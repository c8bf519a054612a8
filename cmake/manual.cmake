# SPDX-License-Identifier: Apache-2.0
# Writes the manual's pages and the completions of shells that PROGRAM prints into the folder TO, as they are installed:
# cmake -DPROGRAM=.. -DTO=.. -P manual.cmake
function(write file)
  execute_process(COMMAND ${PROGRAM} ${ARGN} OUTPUT_FILE "${TO}/${file}" COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(REMOVE_RECURSE "${TO}")
file(MAKE_DIRECTORY "${TO}/man1" "${TO}/bash" "${TO}/zsh" "${TO}/fish")
execute_process(COMMAND ${PROGRAM} man --list OUTPUT_VARIABLE verbs OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" ";" verbs "${verbs}")
write(man1/standoff.1 man)
foreach(verb IN LISTS verbs)
  write(man1/standoff-${verb}.1 man ${verb})
endforeach()
write(bash/standoff completion bash)
write(zsh/_standoff completion zsh)
write(fish/standoff.fish completion fish)
file(TOUCH "${TO}/written")
