# Kernels are compiled once per instruction set and chosen at run time (src/simd/).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(STANDOFF_AVX2_FLAGS -mavx2 -mfma)
  # GCC 12 warns of its own header's undefined registers.
  set(STANDOFF_AVX512_FLAGS -mavx512f -mavx512dq -mavx512bw -mavx512vl -mfma -mprefer-vector-width=512
      -Wno-uninitialized -Wno-maybe-uninitialized)
  # The same code as in kernels_portable.cpp, where undefined behaviour is looked for; once more costs half a minute.
  if("undefined" IN_LIST STANDOFF_SANITIZE)
    list(APPEND STANDOFF_AVX2_FLAGS -fno-sanitize=undefined)
    list(APPEND STANDOFF_AVX512_FLAGS -fno-sanitize=undefined)
  endif()
  foreach(feature IN ITEMS field collision)
    set_source_files_properties(src/${feature}/cpu/kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS "${STANDOFF_AVX2_FLAGS}")
    set_source_files_properties(src/${feature}/cpu/kernels_avx512.cpp PROPERTIES COMPILE_OPTIONS "${STANDOFF_AVX512_FLAGS}")
  endforeach()
endif()
# Pointers are left to the address sanitizer here: with these checks the kernels take three times as long to compile.
if("undefined" IN_LIST STANDOFF_SANITIZE AND "address" IN_LIST STANDOFF_SANITIZE)
  set_source_files_properties(src/field/cpu/kernels_portable.cpp PROPERTIES COMPILE_OPTIONS "-fno-sanitize=alignment,null,object-size")
endif()
