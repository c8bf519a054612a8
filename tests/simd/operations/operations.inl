// SPDX-License-Identifier: Apache-2.0
// The table of operations for this file's instruction set (simd/target.h). All in a namespace without a name, as the
// kernels are: no copy compiled for one processor may serve others.
#pragma once

#include "simd/points.inl"
#include "simd/target.h"
#include "tests/simd/operations/operations.h"

namespace standoff::testing {
namespace {

using namespace standoff::STANDOFF_TARGET;

#define STANDOFF_UNARY(expression)     \
  [](Floats p, float* out) {           \
    const auto a = WideFloat::load(p); \
    (expression).store(out);           \
  }
#define STANDOFF_BINARY(expression)                            \
  [](Floats p, Floats q, float* out) {                         \
    const auto a = WideFloat::load(p), b = WideFloat::load(q); \
    (expression).store(out);                                   \
  }

#define STANDOFF_DOUBLE_UNARY(expression) \
  [](const double* p, double* out) {      \
    const auto a = WideDouble::load(p);   \
    (expression).store(out);              \
  }
#define STANDOFF_DOUBLE_BINARY(expression)                       \
  [](const double* p, const double* q, double* out) {            \
    const auto a = WideDouble::load(p), b = WideDouble::load(q); \
    (expression).store(out);                                     \
  }

constexpr DoubleOperations double_operations() {
  DoubleOperations o{};
  o.add = STANDOFF_DOUBLE_BINARY(a + b);
  o.subtract = STANDOFF_DOUBLE_BINARY(a - b);
  o.multiply = STANDOFF_DOUBLE_BINARY(a * b);
  o.divide = STANDOFF_DOUBLE_BINARY(a / b);
  o.min = STANDOFF_DOUBLE_BINARY(min(a, b));
  o.max = STANDOFF_DOUBLE_BINARY(max(a, b));
  o.negate = STANDOFF_DOUBLE_UNARY(-a);
  o.sqrt = STANDOFF_DOUBLE_UNARY(sqrt(a));
  o.fma = [](const double* a, const double* b, const double* c, double* out) {
    fma(WideDouble::load(a), WideDouble::load(b), WideDouble::load(c)).store(out);
  };
  o.broadcast = [](double value, double* out) { WideDouble(value).store(out); };
  o.less = [](const double* a, const double* b) {
    return Bits{less(WideDouble::load(a), WideDouble::load(b)).to_bits()};
  };
  o.mask_not = [](Bits a) { return Bits{negated(double_mask_from_bits(a)).to_bits()}; };
  o.mask_and = [](Bits a, Bits b) { return Bits{(double_mask_from_bits(a) & double_mask_from_bits(b)).to_bits()}; };
  o.mask_or = [](Bits a, Bits b) { return Bits{(double_mask_from_bits(a) | double_mask_from_bits(b)).to_bits()}; };
  o.mask_xor = [](Bits a, Bits b) { return Bits{(double_mask_from_bits(a) ^ double_mask_from_bits(b)).to_bits()}; };
  o.select = [](Bits m, const double* yes, const double* no, double* out) {
    select(double_mask_from_bits(m), WideDouble::load(yes), WideDouble::load(no)).store(out);
  };
  o.load_column = [](const double(*rows)[4], int axis, double* out) { load_column(rows, axis).store(out); };
  o.store_local = [](const double* v, double scale, const double* center, double* out) {
    store_local(out, v, scale, center);
  };
  o.of_lane = [](const double* a, int lane, double* out) { of_lane(WideDouble::load(a), lane).store(out); };
  o.look_up[0] = [](const double(&table)[8], Uints a, double* out) { look_up<0>(table, a).store(out); };
  o.look_up[1] = [](const double(&table)[8], Uints a, double* out) { look_up<6>(table, a).store(out); };
  o.round = [](const double* a, float* out) { store_rounded(out, WideDouble::load(a)); };
  o.round_pairs = [](const double* a, const double* b, float(*out)[2]) {
    store_rounded_pairs(out, WideDouble::load(a), WideDouble::load(b));
  };
  return o;
}

constexpr SimdOperations operations_of_this_target() {
  SimdOperations o{};
  o.name = STANDOFF_TARGET_NAME;
  o.add = STANDOFF_BINARY(a + b);
  o.subtract = STANDOFF_BINARY(a - b);
  o.multiply = STANDOFF_BINARY(a * b);
  o.divide = STANDOFF_BINARY(a / b);
  o.min = STANDOFF_BINARY(min(a, b));
  o.max = STANDOFF_BINARY(max(a, b));
  o.negate = STANDOFF_UNARY(-a);
  o.sqrt = STANDOFF_UNARY(sqrt(a));
  o.abs = STANDOFF_UNARY(abs(a));
  o.fma = [](Floats a, Floats b, Floats c, float* out) {
    fma(WideFloat::load(a), WideFloat::load(b), WideFloat::load(c)).store(out);
  };
  o.broadcast = [](float value, float* out) { WideFloat(value).store(out); };
  o.broadcast_int = [](int value, float* out) { WideFloat(value).store(out); };
  o.reduce_max = [](Floats a) { return reduce_max(WideFloat::load(a)); };
  o.reduce_min = [](Floats a) { return reduce_min(WideFloat::load(a)); };
  o.truncate = [](Floats a, int* out) { store_truncated(out, WideFloat::load(a)); };
  o.less = [](Floats a, Floats b) { return Bits{less(WideFloat::load(a), WideFloat::load(b)).to_bits()}; };
  o.less_equal = [](Floats a, Floats b) { return Bits{less_equal(WideFloat::load(a), WideFloat::load(b)).to_bits()}; };
  o.equal = [](Floats a, Floats b) { return Bits{equal(WideFloat::load(a), WideFloat::load(b)).to_bits()}; };
  o.mask_not = [](Bits a) { return Bits{(~mask_from_bits(a)).to_bits()}; };
  o.mask_and = [](Bits a, Bits b) { return Bits{(mask_from_bits(a) & mask_from_bits(b)).to_bits()}; };
  o.mask_or = [](Bits a, Bits b) { return Bits{(mask_from_bits(a) | mask_from_bits(b)).to_bits()}; };
  o.select = [](Bits m, Floats yes, Floats no, float* out) {
    select(mask_from_bits(m), WideFloat::load(yes), WideFloat::load(no)).store(out);
  };
  o.pack = [](Bits m, Floats a, float* out) { store_packed(out, mask_from_bits(m), WideFloat::load(a)); };
  o.load_column = [](const float(*rows)[4], int axis, float* out) { load_column(rows, axis).store(out); };
  o.store_local = [](const double* v, double scale, const double* center, float* out) {
    store_local(out, v, scale, center);
  };
  o.add_uints = [](Uints a, Uints b, std::uint32_t* out) { (WideUint::load(a) + WideUint::load(b)).store(out); };
  o.broadcast_uint = [](std::uint32_t value, std::uint32_t* out) { WideUint(value).store(out); };
  o.lane_numbers = [](std::uint32_t* out) { lane_numbers().store(out); };
  o.less_uints = [](Uints a, Uints b) { return Bits{less(WideUint::load(a), WideUint::load(b)).to_bits()}; };
  o.equal_uints = [](Uints a, Uints b) { return Bits{equal(WideUint::load(a), WideUint::load(b)).to_bits()}; };
  o.select_uints = [](Bits m, Uints yes, Uints no, std::uint32_t* out) {
    select(mask_from_bits(m), WideUint::load(yes), WideUint::load(no)).store(out);
  };
  o.pack_uints = [](Bits m, Uints a, std::uint32_t* out) {
    return store_packed(out, mask_from_bits(m), WideUint::load(a));
  };
  o.doubles = double_operations();
  return o;
}

#undef STANDOFF_UNARY
#undef STANDOFF_BINARY
#undef STANDOFF_DOUBLE_UNARY
#undef STANDOFF_DOUBLE_BINARY

}  // namespace
}  // namespace standoff::testing
