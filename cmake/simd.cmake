# The gather kernels are compiled once per instruction set and chosen at run time (src/cpu/simd/).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(DIFI_AVX2_FLAGS -mavx2 -mfma)
  # GCC 12 warns of its own header's undefined registers.
  set(DIFI_AVX512_FLAGS -mavx512f -mavx512dq -mavx512bw -mavx512vl -mfma -mprefer-vector-width=512
      -Wno-uninitialized -Wno-maybe-uninitialized)
  set_source_files_properties(src/cpu/kernels_avx2.cpp src/collision/kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS "${DIFI_AVX2_FLAGS}")
  set_source_files_properties(src/cpu/kernels_avx512.cpp src/collision/kernels_avx512.cpp PROPERTIES COMPILE_OPTIONS "${DIFI_AVX512_FLAGS}")
endif()
