# SPDX-License-Identifier: Apache-2.0
# Kernels are compiled once per instruction set and chosen at run time (src/simd/). tests/gpu_check includes this too.
get_filename_component(STANDOFF_KERNELS ${CMAKE_CURRENT_LIST_DIR}/../src ABSOLUTE)
foreach(feature IN ITEMS field collision points sidecars sign)
  set_source_files_properties(${STANDOFF_KERNELS}/${feature}/cpu/kernels_portable.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
endforeach()
# It takes in all of the namespace cpu, whose cells are not those of its neighbours.
set_source_files_properties(${STANDOFF_KERNELS}/points/nearest.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
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
  foreach(feature IN ITEMS field collision points sidecars sign)
    set_source_files_properties(${STANDOFF_KERNELS}/${feature}/cpu/kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS "${STANDOFF_AVX2_FLAGS}")
    set_source_files_properties(${STANDOFF_KERNELS}/${feature}/cpu/kernels_avx512.cpp PROPERTIES COMPILE_OPTIONS "${STANDOFF_AVX512_FLAGS}")
  endforeach()
endif()
# Pointers are left to the address sanitizer here: with these checks the kernels take three times as long to compile.
if("undefined" IN_LIST STANDOFF_SANITIZE AND "address" IN_LIST STANDOFF_SANITIZE)
  set_source_files_properties(${STANDOFF_KERNELS}/field/cpu/kernels_portable.cpp PROPERTIES COMPILE_OPTIONS "-fno-sanitize=alignment,null,object-size")
endif()
# Fuzzers ask for no field: its kernels must only link. Under clang's sanitizers they take minutes to compile.
if(STANDOFF_BUILD_FUZZERS)
  foreach(set IN ITEMS portable avx2 avx512)
    string(TOUPPER ${set} name)
    set_source_files_properties(${STANDOFF_KERNELS}/field/cpu/kernels_${set}.cpp PROPERTIES COMPILE_OPTIONS "${STANDOFF_${name}_FLAGS};-fno-sanitize=all;-O0")
  endforeach()
  # The sets that a machine of today chooses are asked by the fuzzer of bodies, and go without these checks too.
  set_source_files_properties(src/collision/cpu/kernels_portable.cpp PROPERTIES COMPILE_OPTIONS "-fno-sanitize=undefined")
endif()
