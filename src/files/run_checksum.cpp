// SPDX-License-Identifier: Apache-2.0
// Both checksums are linear in what came before. Adler-32 has a closed form; the CRC of a run is looked up, and moved
// into place by a product of polynomials, as zlib's crc32_combine does.
#include "files/run_checksum.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

namespace standoff {
namespace {

constexpr std::uint64_t kFine = 2048;

// a * b modulo the polynomial of CRC-32, coefficients of low powers in high bits.
std::uint32_t product(std::uint32_t a, std::uint32_t b) {
  constexpr std::uint32_t kPolynomial = 0xEDB88320;
  std::uint32_t sum = 0;
  for (; a != 0; a <<= 1) {
    sum ^= b & (0u - (a >> 31));
    b = (b >> 1) ^ (kPolynomial & (0u - (b & 1)));
  }
  return sum;
}

// x^(8 * bytes).
std::uint32_t shift_by(std::uint64_t bytes) {
  std::uint32_t power = 1u << 31, square = 1u << 23;  // 1 and x^8
  for (; bytes != 0; bytes >>= 1, square = product(square, square))
    if (bytes & 1) power = product(power, square);
  return power;
}

std::uint32_t crc_of(std::uint32_t before, const void* bytes, std::size_t count) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(bytes), count));
}

}  // namespace

std::uint32_t adler32_of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count) {
  constexpr std::uint64_t kPrime = 65521;
  const std::uint64_t bytes = element.size(), n = count % kPrime;
  std::uint64_t sum = 0, weighted = 0;
  for (std::size_t k = 0; k < bytes; ++k) {
    sum += static_cast<std::uint64_t>(element[k]);
    weighted += (bytes - k) * static_cast<std::uint64_t>(element[k]);
  }
  sum %= kPrime;
  // 0 + 1 + ... + (count - 1): one of both factors is even.
  const std::uint64_t pairs =
      count % 2 == 0 ? (count / 2 % kPrime) * ((count - 1) % kPrime) % kPrime : n * ((count - 1) / 2 % kPrime) % kPrime;
  const std::uint64_t low = before & 0xFFFF, high = before >> 16;
  const std::uint64_t new_low = (low + n * sum) % kPrime;
  const std::uint64_t new_high =
      (high + bytes % kPrime * (n * low % kPrime) + n * (weighted % kPrime) + bytes % kPrime * (sum * pairs % kPrime)) %
      kPrime;
  return count == 0 ? before : static_cast<std::uint32_t>(new_high << 16 | new_low);
}

CrcRuns::CrcRuns(std::span<const std::string> elements, std::uint64_t longest) {
  const std::uint64_t bytes = elements[0].size(), coarse = longest / kFine + 1;
  const std::uint32_t step = shift_by(bytes), long_step = shift_by(bytes * kFine);
  fine_.push_back(shift_by(0));
  while (fine_.size() < kFine) fine_.push_back(product(fine_.back(), step));
  coarse_.push_back(shift_by(0));
  while (coarse_.size() < coarse) coarse_.push_back(product(coarse_.back(), long_step));
  for (const std::string& element : elements) {
    Known known{element, {0}, {0}};
    while (known.fine.size() <= kFine) known.fine.push_back(crc_of(known.fine.back(), element.data(), element.size()));
    while (known.coarse.size() < coarse)
      known.coarse.push_back(product(long_step, known.coarse.back()) ^ known.fine[kFine]);
    known_.push_back(std::move(known));
  }
}

std::uint32_t CrcRuns::joined(std::uint32_t first, std::uint32_t second, std::uint64_t elements) const {
  return product(coarse_[elements / kFine], product(fine_[elements % kFine], first)) ^ second;
}

std::uint32_t CrcRuns::of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count) const {
  constexpr std::uint64_t kFewBytes = 256;
  const std::uint64_t bytes = element.size();
  if (count * bytes > kFewBytes)
    for (const Known& known : known_) {
      if (std::memcmp(known.element.data(), element.data(), bytes) != 0) continue;
      const std::uint64_t many = count / kFine, few = count % kFine;
      std::uint32_t crc = before;
      if (many > 0) crc = product(coarse_[many], crc) ^ known.coarse[many];
      return product(fine_[few], crc) ^ known.fine[few];
    }
  std::byte copies[1024];
  const std::uint64_t at_once = std::min<std::uint64_t>(sizeof copies / bytes, count);
  for (std::uint64_t n = 0; n < at_once; ++n) std::memcpy(copies + n * bytes, element.data(), bytes);
  for (; count > 0; count -= std::min(at_once, count))
    before = crc_of(before, copies, std::min(at_once, count) * bytes);
  return before;
}

}  // namespace standoff
