# SPDX-License-Identifier: Apache-2.0
# Flags that every target of the project shares.
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Contraction stays off: results must not depend on which multiply-adds a compiler fuses. Where one pays, the code says fma.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-ffp-contract=off>)
# GCC 12 packs neighbours of the form double(float(x)) into one register and forgets to round them there, from -O2 on
# (tests/geometry/rounding_test.cpp). With sanitizers all is built with -O1.
if(NOT STANDOFF_SANITIZE)
  add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fno-tree-slp-vectorize>)
endif()
# sqrt must not look at errno, or it cannot be vectorised.
add_compile_options($<$<COMPILE_LANGUAGE:CXX>:-fno-math-errno>)

foreach(sanitizer IN LISTS STANDOFF_SANITIZE)
  add_compile_options(-fsanitize=${sanitizer} -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${sanitizer})
endforeach()
if("thread" IN_LIST STANDOFF_SANITIZE)
  include_directories(BEFORE ${CMAKE_CURRENT_SOURCE_DIR}/tests/tsan)  # a TBB whose order the sanitizer sees
endif()
if(STANDOFF_SANITIZE)
  add_compile_options(-fno-sanitize-recover=undefined)
endif()
if(STANDOFF_BUILD_FUZZERS)
  add_compile_options(-fsanitize=fuzzer-no-link)  # so that a fuzzer sees which branches a file takes
endif()
if(STANDOFF_COVERAGE)
  # Atomic: threads that count at once leave negative numbers, at which gcovr stops.
  add_compile_options(--coverage -fprofile-update=atomic)
  add_link_options(--coverage)
endif()

# Headers are read once for a batch. Sources with flags of their own, and those marked SKIP_UNITY_BUILD_INCLUSION, stay alone.
if(STANDOFF_UNITY)
  set(CMAKE_UNITY_BUILD ON)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 16)
endif()

add_library(standoff_warnings INTERFACE)
target_compile_options(standoff_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wall;-Wextra;-Wshadow;-Wconversion;-Wno-sign-conversion>)
