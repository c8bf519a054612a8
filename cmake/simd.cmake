# SPDX-License-Identifier: Apache-2.0
# Kernels are compiled once per instruction set and chosen at run time (src/simd/). tests/gpu_check includes this too.
set(STANDOFF_SETS portable)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  list(APPEND STANDOFF_SETS avx2 avx512)
  set(STANDOFF_AVX2_FLAGS -mavx2 -mfma)
  # GCC 12 warns of its own header's undefined registers.
  set(STANDOFF_AVX512_FLAGS -mavx512f -mavx512dq -mavx512bw -mavx512vl -mfma -mprefer-vector-width=512
      -Wno-uninitialized -Wno-maybe-uninitialized)
  # The same code as in kernels_portable.cpp, where undefined behaviour is looked for; once more costs half a minute. Of the
  # sets that a machine of today has, the widest is looked at: it is what tests run by default.
  if(STANDOFF_SANITIZE)
    list(APPEND STANDOFF_AVX2_FLAGS -fno-sanitize=all)
    list(APPEND STANDOFF_AVX512_FLAGS -fno-sanitize=undefined)
  endif()
endif()

# standoff_kernels(VARIABLE TABLE ...): appends to the variable a source for each set of each table, FEATURE/cpu/kernels_SET.cpp. A
# table is a fragment below src, in its feature's folder.
function(standoff_kernels variable)
  foreach(table IN LISTS ARGN)
    string(REGEX REPLACE "/.*" "" feature ${table})
    foreach(set IN LISTS STANDOFF_SETS)
      string(TOUPPER ${set} name)
      set(STANDOFF_TARGET_${name} ON)
      set(source ${CMAKE_CURRENT_BINARY_DIR}/kernels/${feature}/cpu/kernels_${set}.cpp)
      configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/kernels.cpp.in ${source})
      unset(STANDOFF_TARGET_${name})
      set(flags ${STANDOFF_${name}_FLAGS})
      # Pointers are left to the address sanitizer here: with these checks the kernels take three times as long to compile.
      if(source MATCHES "/field/cpu/kernels_portable" AND "undefined" IN_LIST STANDOFF_SANITIZE AND "address" IN_LIST STANDOFF_SANITIZE)
        set(flags -fno-sanitize=alignment,null,object-size)
      endif()
      # Fuzzers ask for no field: its kernels must only link. Under clang's sanitizers they take minutes to compile. The sets that
      # a machine of today chooses are asked by the fuzzer of bodies, and go without these checks too.
      if(STANDOFF_BUILD_FUZZERS AND feature STREQUAL field)
        list(APPEND flags -fno-sanitize=all -O0)
      elseif(STANDOFF_BUILD_FUZZERS AND source MATCHES "/collision/cpu/kernels_portable")
        set(flags -fno-sanitize=undefined)
      endif()
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON COMPILE_OPTIONS "${flags}")
      list(APPEND ${variable} ${source})
    endforeach()
  endforeach()
  set(${variable} ${${variable}} PARENT_SCOPE)
endfunction()
