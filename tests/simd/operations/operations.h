// SPDX-License-Identifier: Apache-2.0
// The operations of a SIMD target (src/simd) on sixteen lanes in memory: what the tests compare with plain numbers.
#pragma once

#include <cstdint>

namespace standoff::testing {

using Floats = const float*;
using Uints = const std::uint32_t*;
using Bits = std::uint32_t;  ///< a mask: lane n is bit n

/// Those of WideDouble: every pointer is to eight lanes.
struct DoubleOperations {
  void (*add)(const double*, const double*, double* out);
  void (*subtract)(const double*, const double*, double* out);
  void (*multiply)(const double*, const double*, double* out);
  void (*divide)(const double*, const double*, double* out);
  void (*min)(const double*, const double*, double* out);
  void (*max)(const double*, const double*, double* out);
  void (*negate)(const double*, double* out);
  void (*sqrt)(const double*, double* out);
  void (*fma)(const double*, const double*, const double*, double* out);
  void (*broadcast)(double, double* out);
  Bits (*less)(const double*, const double*);
  Bits (*mask_not)(Bits);
  Bits (*mask_and)(Bits, Bits);
  Bits (*mask_or)(Bits, Bits);
  Bits (*mask_xor)(Bits, Bits);
  void (*select)(Bits, const double* yes, const double* no, double* out);
  void (*load_column)(const double (*rows)[4], int axis, double* out);      ///< eight rows
  void (*store_local)(const double* v, double scale, const double* center,  ///< three and four doubles
                      double* out);                                         ///< four, aligned to 32 bytes
  void (*of_lane)(const double*, int lane, double* out);
  void (*look_up[2])(const double (&table)[8], Uints, double* out);  ///< by bits 0 to 2 and 6 to 8 of eight integers
  void (*round)(const double*, float* out);
  void (*round_pairs)(const double*, const double*, float (*out)[2]);
};

/// Every pointer is to sixteen lanes unless said otherwise; `out` may not overlap the others.
struct SimdOperations {
  const char* name;
  void (*add)(Floats, Floats, float* out);
  void (*subtract)(Floats, Floats, float* out);
  void (*multiply)(Floats, Floats, float* out);
  void (*divide)(Floats, Floats, float* out);
  void (*min)(Floats, Floats, float* out);
  void (*max)(Floats, Floats, float* out);
  void (*negate)(Floats, float* out);
  void (*sqrt)(Floats, float* out);
  void (*abs)(Floats, float* out);
  void (*fma)(Floats, Floats, Floats, float* out);
  void (*broadcast)(float, float* out);
  void (*broadcast_int)(int, float* out);
  float (*reduce_max)(Floats);
  float (*reduce_min)(Floats);
  void (*truncate)(Floats, int* out);
  Bits (*less)(Floats, Floats);
  Bits (*less_equal)(Floats, Floats);
  Bits (*equal)(Floats, Floats);
  Bits (*mask_not)(Bits);
  Bits (*mask_and)(Bits, Bits);
  Bits (*mask_or)(Bits, Bits);
  void (*select)(Bits, Floats yes, Floats no, float* out);
  void (*pack)(Bits, Floats, float* out);
  void (*load_column)(const float (*rows)[4], int axis, float* out);        ///< sixteen rows
  void (*store_local)(const double* v, double scale, const double* center,  ///< three and four doubles
                      float* out);                                          ///< four, aligned to 16 bytes
  void (*add_uints)(Uints, Uints, std::uint32_t* out);
  void (*broadcast_uint)(std::uint32_t, std::uint32_t* out);
  void (*lane_numbers)(std::uint32_t* out);
  Bits (*less_uints)(Uints, Uints);
  Bits (*equal_uints)(Uints, Uints);
  void (*select_uints)(Bits, Uints yes, Uints no, std::uint32_t* out);
  int (*pack_uints)(Bits, Uints, std::uint32_t* out);
  DoubleOperations doubles;
};

extern const SimdOperations kPortableOperations;
#ifdef __x86_64__
extern const SimdOperations kAvx2Operations;
extern const SimdOperations kAvx512Operations;
#endif

}  // namespace standoff::testing
