// SPDX-License-Identifier: Apache-2.0
// Eight doubles as four of the compiler's own vectors, which every processor's baseline has. Same names and same
// results as wide_double_avx512.h.
#pragma once

#include <cstdint>

#include "geometry/scalar.h"

namespace standoff::portable {

using Doubles = double __attribute__((vector_size(16)));
using LongInts = std::int64_t __attribute__((vector_size(16)));
constexpr int kDoubleParts = 4, kDoublePartLanes = 2;

/// T(f(0), ..., f(3)): one operation on all parts.
template <class T, class Function>
STANDOFF_INLINE T by_double_parts(Function f) {
  T result;
  for (int part = 0; part < kDoubleParts; ++part) result.v[part] = f(part);
  return result;
}
#define STANDOFF_LANES [&](int part) __attribute__((always_inline))

struct DoubleMask {
  LongInts v[kDoubleParts];  // all bits of a lane, or none

  STANDOFF_INLINE std::uint32_t to_bits() const {
    const LongInts bit{1, 2};
    LongInts set{};
    for (int part = 0; part < kDoubleParts; ++part) set |= v[part] & (bit << (kDoublePartLanes * part));
    return static_cast<std::uint32_t>(set[0] | set[1]);
  }
  friend STANDOFF_INLINE DoubleMask operator&(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] & b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask operator|(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] | b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask operator^(const DoubleMask& a, const DoubleMask& b) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] ^ b.v[part]; });
  }
  friend STANDOFF_INLINE DoubleMask negated(const DoubleMask& a) {
    return by_double_parts<DoubleMask>(STANDOFF_LANES { return ~a.v[part]; });
  }
};

struct WideDouble {
  static constexpr int kLanes = 8;
  Doubles v[kDoubleParts];

  WideDouble() = default;
  STANDOFF_INLINE explicit WideDouble(double value) {
    for (Doubles& part : v) part = Doubles{value, value};
  }

  static STANDOFF_INLINE WideDouble load(const double* p) {
    WideDouble result;
    __builtin_memcpy(result.v, p, sizeof result.v);
    return result;
  }
  STANDOFF_INLINE void store(double* p) const { __builtin_memcpy(p, v, sizeof v); }

  friend STANDOFF_INLINE WideDouble operator+(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] + b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator-(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] - b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator*(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] * b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator/(const WideDouble& a, const WideDouble& b) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] / b.v[part]; });
  }
  friend STANDOFF_INLINE WideDouble operator-(const WideDouble& a) {
    return by_double_parts<WideDouble>(STANDOFF_LANES { return -a.v[part]; });
  }
};

STANDOFF_INLINE WideDouble fma(const WideDouble& a, const WideDouble& b, const WideDouble& c) {
  return by_double_parts<WideDouble>(STANDOFF_LANES {
    return Doubles{standoff::fma(a.v[part][0], b.v[part][0], c.v[part][0]),
                   standoff::fma(a.v[part][1], b.v[part][1], c.v[part][1])};
  });
}
STANDOFF_INLINE WideDouble min(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] < b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideDouble max(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return a.v[part] > b.v[part] ? a.v[part] : b.v[part]; });
}
STANDOFF_INLINE WideDouble sqrt(const WideDouble& a) {
  return by_double_parts<WideDouble>(STANDOFF_LANES {
    return Doubles{standoff::sqrt(a.v[part][0]), standoff::sqrt(a.v[part][1])};
  });
}
STANDOFF_INLINE DoubleMask less(const WideDouble& a, const WideDouble& b) {
  return by_double_parts<DoubleMask>(STANDOFF_LANES { return a.v[part] < b.v[part]; });
}
STANDOFF_INLINE WideDouble select(const DoubleMask& m, const WideDouble& yes, const WideDouble& no) {
  return by_double_parts<WideDouble>(STANDOFF_LANES { return m.v[part] ? yes.v[part] : no.v[part]; });
}
#undef STANDOFF_LANES

/// Stores (v * scale - center), and zero as the fourth number. v has three doubles, center four.
STANDOFF_INLINE void store_local(double* out, const double* v, double scale, const double* center) {
  for (int axis = 0; axis < 3; ++axis) out[axis] = standoff::fma(v[axis], scale, -center[axis]);
  out[3] = 0;
}

/// Column `axis` of eight rows of four.
STANDOFF_INLINE WideDouble load_column(const double (*rows)[4], int axis) {
  double column[WideDouble::kLanes];
  for (int n = 0; n < WideDouble::kLanes; ++n) column[n] = rows[n][axis];
  return WideDouble::load(column);
}

/// The numbers of a table that the three bits from kShift on of each of eight integers name.
template <int kShift>
STANDOFF_INLINE WideDouble look_up(const double (&table)[8], const std::uint32_t* integers) {
  double found[WideDouble::kLanes];
  for (int n = 0; n < WideDouble::kLanes; ++n) found[n] = table[integers[n] >> kShift & 7];
  return WideDouble::load(found);
}

/// The lanes whose bit is set.
STANDOFF_INLINE DoubleMask double_mask_from_bits(std::uint32_t bits) {
  DoubleMask m;
  for (int part = 0; part < kDoubleParts; ++part) {
    const std::int64_t two = bits >> (kDoublePartLanes * part);
    const LongInts bit{1, 2};
    m.v[part] = (LongInts{two, two} & bit) == bit;
  }
  return m;
}

/// The lanes rounded to float.
STANDOFF_INLINE void store_rounded(float* out, const WideDouble& a) {
  double lanes[WideDouble::kLanes];
  a.store(lanes);
  for (int n = 0; n < WideDouble::kLanes; ++n) out[n] = static_cast<float>(lanes[n]);
}
/// Pairs of lanes of a and b.
STANDOFF_INLINE void store_rounded_pairs(float (*out)[2], const WideDouble& a, const WideDouble& b) {
  float first[WideDouble::kLanes], second[WideDouble::kLanes];
  store_rounded(first, a);
  store_rounded(second, b);
  for (int n = 0; n < WideDouble::kLanes; ++n) out[n][0] = first[n], out[n][1] = second[n];
}

}  // namespace standoff::portable
