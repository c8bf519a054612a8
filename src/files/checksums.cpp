// SPDX-License-Identifier: Apache-2.0
#include "files/checksums.h"

#ifdef __x86_64__
#include <wmmintrin.h>
#endif

#include <array>
#include <bit>
#include <cstring>

namespace standoff {

static_assert(std::endian::native == std::endian::little, "eight bytes are taken as a word whose first byte is low");

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

// The CRC is a remainder of polynomials over two elements. Their coefficients stand in words backwards: those of low
// powers in high bits. It is linear in what came before, which a product moves past what follows.

namespace {

constexpr std::uint32_t kPolynomial = 0xEDB88320;

// a * b modulo the polynomial.
constexpr std::uint32_t product_by_bits(std::uint32_t a, std::uint32_t b) {
  std::uint32_t sum = 0;
  for (; a != 0; a <<= 1) {
    sum ^= b & (0u - (a >> 31));
    b = (b >> 1) ^ (kPolynomial & (0u - (b & 1)));
  }
  return sum;
}

constexpr std::uint32_t kOne = 1u << 31;

// x^(8 * bytes).
constexpr std::uint32_t shift_by(std::uint64_t bytes) {
  std::uint32_t power = kOne, square = 1u << 23;  // 1 and x^8
  for (; bytes != 0; bytes >>= 1, square = product_by_bits(square, square))
    if (bytes & 1) power = product_by_bits(power, square);
  return power;
}

// Table k: the CRC of a byte with k zero bytes behind it (Kounavis and Berry, "Novel table lookup-based algorithms for
// high-performance CRC generation", 2008).
constexpr auto kTables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (kPolynomial & (0u - (crc & 1)));
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < tables.size(); ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFF];
  return tables;
}();

// The remainder after these bytes, without the inversions at both ends.
std::uint32_t remainder_by_tables(std::uint32_t before, const std::byte* at, std::size_t count) {
  const auto& t = kTables;
  for (; count >= 8; count -= 8, at += 8) {
    std::uint64_t word;
    std::memcpy(&word, at, sizeof word);
    word ^= before;
    const auto byte = [word](int n) { return (word >> (8 * n)) & 0xFF; };
    before = t[7][byte(0)] ^ t[6][byte(1)] ^ t[5][byte(2)] ^ t[4][byte(3)] ^  //
             t[3][byte(4)] ^ t[2][byte(5)] ^ t[1][byte(6)] ^ t[0][byte(7)];
  }
  for (; count > 0; --count, ++at) before = (before >> 8) ^ t[0][(before ^ static_cast<std::uint32_t>(*at)) & 0xFF];
  return before;
}

#ifdef __x86_64__

// Most processors multiply such polynomials at once. Bytes are folded: those of a register are multiplied so that they
// move past what follows, where they are added, until 16 bytes with the same remainder are left (Gopal et al., "Fast
// CRC computation for generic polynomials using PCLMULQDQ instruction", 2009).

const bool kMultiplies = __builtin_cpu_supports("pclmul") != 0;
constexpr std::size_t kRegister = 16, kRegisters = 4, kLeastFolded = 2 * kRegister;

// What moves the halves of a register past so many bytes. The product of words that stand backwards is one bit short.
constexpr std::array<std::uint64_t, 2> past(std::size_t bytes) {
  return {std::uint64_t{shift_by(bytes + 4)} << 1, std::uint64_t{shift_by(bytes - 4)} << 1};
}
constexpr auto kPastOne = past(kRegister), kPastAll = past(kRegister * kRegisters);

__attribute__((target("pclmul"))) __m128i load(const std::byte* at) {
  return _mm_loadu_si128(reinterpret_cast<const __m128i*>(at));
}

__attribute__((target("pclmul"))) __m128i folded(__m128i bytes, const std::array<std::uint64_t, 2>& past,
                                                 __m128i onto) {
  const __m128i by = _mm_set_epi64x(static_cast<long long>(past[1]), static_cast<long long>(past[0]));
  return _mm_xor_si128(onto,
                       _mm_xor_si128(_mm_clmulepi64_si128(bytes, by, 0x00), _mm_clmulepi64_si128(bytes, by, 0x11)));
}

// Requires kLeastFolded bytes.
__attribute__((target("pclmul"))) std::uint32_t remainder_by_folding(std::uint32_t before, const std::byte* at,
                                                                     std::size_t count) {
  const __m128i start = _mm_cvtsi32_si128(static_cast<int>(before));
  __m128i one = _mm_xor_si128(load(at), start);
  at += kRegister;
  count -= kRegister;
  if (count >= kRegister * (2 * kRegisters - 1)) {
    __m128i two = load(at), three = load(at + kRegister), four = load(at + 2 * kRegister);
    at += kRegister * (kRegisters - 1);
    count -= kRegister * (kRegisters - 1);
    for (; count >= kRegister * kRegisters; at += kRegister * kRegisters, count -= kRegister * kRegisters) {
      one = folded(one, kPastAll, load(at));
      two = folded(two, kPastAll, load(at + kRegister));
      three = folded(three, kPastAll, load(at + 2 * kRegister));
      four = folded(four, kPastAll, load(at + 3 * kRegister));
    }
    one = folded(folded(folded(one, kPastOne, two), kPastOne, three), kPastOne, four);
  }
  for (; count >= kRegister; at += kRegister, count -= kRegister) one = folded(one, kPastOne, load(at));
  std::array<std::byte, kRegister> left;
  _mm_storeu_si128(reinterpret_cast<__m128i*>(left.data()), one);
  return remainder_by_tables(remainder_by_tables(0, left.data(), left.size()), at, count);
}

__attribute__((target("pclmul"))) std::uint64_t multiplied(std::uint32_t a, std::uint32_t b) {
  return static_cast<std::uint64_t>(_mm_cvtsi128_si64(_mm_clmulepi64_si128(
      _mm_cvtsi64_si128(static_cast<long long>(a)), _mm_cvtsi64_si128(static_cast<long long>(b)), 0)));
}

std::uint32_t remainder(std::uint32_t before, std::span<const std::byte> bytes) {
  const auto by = kMultiplies && bytes.size() >= kLeastFolded ? remainder_by_folding : remainder_by_tables;
  return by(before, bytes.data(), bytes.size());
}

std::uint32_t product(std::uint32_t a, std::uint32_t b) {
  if (!kMultiplies) return product_by_bits(a, b);
  const std::uint64_t both = multiplied(a, b) << 1;
  const auto high_powers = static_cast<std::uint32_t>(both);
  const auto byte = [high_powers](int n) { return (high_powers >> (8 * n)) & 0xFF; };
  const auto& t = kTables;
  return static_cast<std::uint32_t>(both >> 32) ^ t[3][byte(0)] ^ t[2][byte(1)] ^ t[1][byte(2)] ^ t[0][byte(3)];
}

#else

std::uint32_t remainder(std::uint32_t before, std::span<const std::byte> bytes) {
  return remainder_by_tables(before, bytes.data(), bytes.size());
}
std::uint32_t product(std::uint32_t a, std::uint32_t b) { return product_by_bits(a, b); }

#endif

// About the root of the longest runs that are asked for.
constexpr std::uint64_t kFine = 512;

}  // namespace

std::uint32_t crc32_of(std::uint32_t before, std::span<const std::byte> bytes) { return ~remainder(~before, bytes); }

CrcRuns::CrcRuns(std::size_t element_bytes, std::uint64_t longest) {
  const auto fill = [](std::vector<Step>& steps, std::uint64_t most, const Step& step) {
    steps.reserve(most + 1);
    steps.push_back({kOne, 0});
    while (steps.size() <= most)
      steps.push_back({product(steps.back().power, step.power), product(steps.back().sum, step.power) ^ step.sum});
  };
  fill(fine_, kFine, {shift_by(element_bytes), kOne});
  fill(coarse_, longest / kFine, fine_[kFine]);
}

CrcRuns::Step CrcRuns::step_of(std::uint64_t elements) const {
  const Step &few = fine_[elements % kFine], &many = coarse_[elements / kFine];
  return {product(few.power, many.power), product(few.power, many.sum) ^ few.sum};
}

std::uint32_t CrcRuns::joined(std::uint32_t first, std::uint32_t second, std::uint64_t elements) const {
  return product(step_of(elements).power, first) ^ second;
}

std::uint32_t CrcRuns::of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count) const {
  std::array<std::byte, 128> copies;  // going through these is faster
  const std::size_t bytes = element.size();
  if (count * bytes > copies.size()) {
    const Step step = step_of(count);
    return ~(product(step.power, ~before) ^ product(step.sum, remainder(0, element)));
  }
  if (bytes == 4)
    for (std::size_t n = 0; n < count; ++n) std::memcpy(copies.data() + 4 * n, element.data(), 4);
  else
    for (std::size_t n = 0; n < count; ++n) std::memcpy(copies.data() + bytes * n, element.data(), bytes);
  return crc32_of(before, std::span(copies.data(), count * bytes));
}

}  // namespace standoff
