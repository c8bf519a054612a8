// SPDX-License-Identifier: Apache-2.0
#include "io/field/vdb_values.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "files/zip.h"
#include "io/field/blosc.h"

namespace standoff::vdb {
namespace {

float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  const float sign = bits >> 15 ? -1.0f : 1.0f;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(mantissa), -24);
  if (exponent == 31) return mantissa ? std::nanf("") : sign * INFINITY;
  return sign * std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
}

}  // namespace

const float* ValueReader::read(Cursor& from, const std::uint64_t* active, std::size_t count) {
  const auto is_active = [&](std::size_t n) { return active[n / 64] >> n % 64 & 1; };
  const auto kind = from.number<ValuesKind>();
  if (kind > ValuesKind::all) from.fail("values of a node are stored in no known way; the file is damaged");
  // The mask, where there is one, selects the second.
  float first = kind == ValuesKind::background ? background_ : -background_, second = background_;
  if (kind == ValuesKind::one || kind == ValuesKind::background_or_one || kind == ValuesKind::two)
    first = from.number<float>();
  if (kind == ValuesKind::two) second = from.number<float>();
  const bool masked =
      kind == ValuesKind::background_or_negative || kind == ValuesKind::background_or_one || kind == ValuesKind::two;
  const std::string_view mask = masked ? from.bytes(count / 8, "a mask") : std::string_view();
  std::size_t stored = count;
  if ((compression_ & kActiveMask) && kind != ValuesKind::all) {
    stored = 0;
    for (std::size_t n = 0; n < count / 64; ++n) stored += static_cast<std::size_t>(std::popcount(active[n]));
  }
  read_data(from, stored);
  if (stored == count) return stored_.data();
  values_.resize(count);
  for (std::size_t n = 0, next = 0; n < count; ++n) {
    const bool selected = masked && (mask[n / 8] >> n % 8 & 1);
    values_[n] = is_active(n) ? stored_[next++] : selected ? second : first;
  }
  return values_.data();
}

void ValueReader::read_data(Cursor& from, std::size_t count) {
  stored_.resize(count);
  if (half_ && count == 0) return;
  const std::size_t bytes = count * (half_ ? 2 : 4);
  const std::string_view data =
      compression_ & (kZip | kBlosc) ? unpacked(from, bytes) : from.bytes(bytes, "the values of a node");
  for (std::size_t n = 0; n < count; ++n) {
    std::uint16_t half;
    if (half_) {
      std::memcpy(&half, data.data() + 2 * n, sizeof half);
      stored_[n] = from_half(half);
    } else {
      std::memcpy(&stored_[n], data.data() + 4 * n, sizeof stored_[n]);
    }
  }
}

// After their length when packed; negative if they are not.
std::string_view ValueReader::unpacked(Cursor& from, std::size_t bytes) {
  const std::uint64_t at = from.at();
  const auto length = from.number<std::int64_t>();
  const std::uint64_t packed =
      length < 0 ? ~static_cast<std::uint64_t>(length) + 1 : static_cast<std::uint64_t>(length);
  const std::string_view data = from.bytes(packed, "the packed values of a node");
  if (length <= 0) {
    if (packed != bytes) from.fail("a node has values for another number of samples; the file is damaged");
    return data;
  }
  unpacked_.resize(bytes);
  const std::string where = "byte " + std::to_string(at);
  if (compression_ & kBlosc)
    unpack_blosc(from.file(), where, data, unpacked_);
  else
    Inflater(from.file(), where, data, Inflater::Wrapper::zlib).fill(unpacked_.data(), bytes);
  return {unpacked_.data(), bytes};
}

}  // namespace standoff::vdb
