// SPDX-License-Identifier: Apache-2.0
#include "files/run_deflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "files/huffman.h"

namespace standoff {
namespace {

constexpr std::uint32_t kEndOfBlock = 256, kLongest = 258, kLeastMatch = 3;
constexpr std::size_t kSymbols = 286, kDistances = 30, kLengthCodes = 19;
constexpr int kLongestCode = 15, kLongestLengthCode = 7;

// RFC 1951, section 3.2.5: symbol and extra bits of a length or a distance. Both are powers of two, divided.
struct Coded {
  std::uint32_t symbol, extra_bits, extra;
};
Coded coded_length(std::uint32_t length) {
  if (length == kLongest) return {285, 0, 0};
  const std::uint32_t n = length - kLeastMatch;
  if (n < 8) return {257 + n, 0, 0};
  const auto bits = static_cast<std::uint32_t>(std::bit_width(n)) - 3;
  return {257 + 4 * bits + (n >> bits), bits, n & ((1u << bits) - 1)};
}
Coded coded_distance(std::uint32_t distance) {
  const std::uint32_t n = distance - 1;
  if (n < 4) return {n, 0, 0};
  const auto bits = static_cast<std::uint32_t>(std::bit_width(n)) - 2;
  return {2 * bits + (n >> bits), bits, n & ((1u << bits) - 1)};
}

// The lengths of the matches that a run of so many bytes becomes, none below kLeastMatch; `match(length, times)`.
template <class Match>
void each_match(std::uint32_t run, const Match& match) {
  std::uint32_t longest = run / kLongest, rest = run % kLongest;
  if (rest > 0 && rest < kLeastMatch && longest > 0) {
    --longest;
    match(kLongest - kLeastMatch, 1u);
    rest += kLeastMatch;
  }
  if (longest > 0) match(kLongest, longest);
  if (rest > 0) match(rest, 1u);
}

class Bits {
 public:
  explicit Bits(std::string& out) : out_(out) {}

  void add(std::uint64_t bits, std::uint32_t count) {  // of at most 32
    held_ |= bits << held_count_;
    held_count_ += count;
    if (held_count_ >= 32) {
      if (used_ == buffer_.size()) flush();
      std::memcpy(buffer_.data() + used_, &held_, 4);
      used_ += 4;
      held_ >>= 32;
      held_count_ -= 32;
    }
  }
  void add(const HuffmanCode& code) { add(code.bits, code.length); }
  void to_byte() {
    flush();
    for (; held_count_ > 0; held_count_ -= std::min(held_count_, 8u), held_ >>= 8)
      out_ += static_cast<char>(held_ & 0xFF);
  }

 private:
  void flush() {
    out_.append(buffer_.data(), used_);
    used_ = 0;
  }

  std::string& out_;
  std::uint64_t held_ = 0;
  std::uint32_t held_count_ = 0;
  std::size_t used_ = 0;
  std::array<char, 4096> buffer_;
};

// The codes of a block, and what they cost.
struct Codes {
  std::array<HuffmanCode, kSymbols> symbols{};
  std::array<HuffmanCode, kDistances> distances{};
  std::array<HuffmanCode, kLengthCodes> lengths{};
  std::uint64_t bits = 0;

  Codes(const std::array<std::uint32_t, kSymbols>& counts, std::uint32_t distance_symbol, std::uint64_t matches,
        std::uint64_t extra_bits) {
    make_huffman_codes(counts, kLongestCode, symbols);
    distances[distance_symbol].length = 1;
    std::array<std::uint32_t, kLengthCodes> length_counts{};
    for (const HuffmanCode& code : symbols) ++length_counts[code.length];
    for (const HuffmanCode& code : distances) ++length_counts[code.length];
    make_huffman_codes(length_counts, kLongestLengthCode, lengths);
    bits = 3 + 14 + 3 * kLengthCodes + matches + extra_bits;
    for (std::size_t k = 0; k < kSymbols; ++k)
      bits += std::uint64_t{counts[k]} * symbols[k].length + lengths[symbols[k].length].length;
    for (const HuffmanCode& code : distances) bits += lengths[code.length].length;
  }

  void write(Bits& out, bool last) const {
    constexpr std::array<std::uint8_t, kLengthCodes> kOrder{16, 17, 18, 0, 8,  7, 9,  6, 10, 5,
                                                            11, 4,  12, 3, 13, 2, 14, 1, 15};
    out.add(last ? 1 : 0, 1);
    out.add(2, 2);  // codes of its own
    out.add(kSymbols - 257, 5);
    out.add(kDistances - 1, 5);
    out.add(kLengthCodes - 4, 4);
    for (const std::uint8_t k : kOrder) out.add(lengths[k].length, 3);
    for (const HuffmanCode& code : symbols) out.add(lengths[code.length]);
    for (const HuffmanCode& code : distances) out.add(lengths[code.length]);
  }
};

}  // namespace

void RunDeflater::clear() {
  literals_.clear();
  tokens_.clear();
  run_bytes_ = 0;
}

void RunDeflater::add_literal(const std::byte* element) {
  if (tokens_.empty() || tokens_.back().run > 0) tokens_.emplace_back();
  tokens_.back().literals += static_cast<std::uint32_t>(period_);
  literals_.insert(literals_.end(), element, element + period_);
}

void RunDeflater::add_run(std::uint64_t count) {
  tokens_.back().run += static_cast<std::uint32_t>(count * period_);
  run_bytes_ += count * period_;
}

template <std::size_t bytes>
void RunDeflater::add_elements(const std::byte* from, std::uint64_t count) {
  const std::size_t period = bytes > 0 ? bytes : period_;
  for (; count > 0; --count, from += period) {
    if (!literals_.empty() && std::memcmp(literals_.data() + literals_.size() - period, from, period) == 0)
      add_run(1);
    else
      add_literal(from);
  }
}

void RunDeflater::elements(const std::byte* from, std::uint64_t count) {
  if (period_ == 4) return add_elements<4>(from, count);
  if (period_ == 1) return add_elements<1>(from, count);
  add_elements<0>(from, count);
}

void RunDeflater::run(const std::byte* element, std::uint64_t count) {
  if (count == 0) return;
  elements(element, 1);
  if (count > 1) add_run(count - 1);
}

template <class Literals, class Run>
void RunDeflater::each_token(Literals literals, Run run) const {
  const std::byte* at = literals_.data();
  for (const Token& token : tokens_) {
    literals(std::span(at, token.literals));
    at += token.literals;
    const std::span element(at - period_, period_);
    // Too short for a match.
    if (token.run > 0 && token.run < kLeastMatch)
      for (std::uint32_t n = 0; n < token.run; n += static_cast<std::uint32_t>(period_)) literals(element);
    else if (token.run > 0)
      run(element, token.run);
  }
}

void RunDeflater::deflate(std::string& out, End end) const {
  std::array<std::uint32_t, kSymbols> counts{};
  std::uint64_t matches = 0, extra_bits = 0;
  const Coded distance = coded_distance(static_cast<std::uint32_t>(period_));
  each_token(
      [&](std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) ++counts[static_cast<std::size_t>(byte)];
      },
      [&](auto, std::uint32_t run) {
        each_match(run, [&](std::uint32_t length, std::uint32_t times) {
          const Coded coded = coded_length(length);
          counts[coded.symbol] += times;
          matches += times;
          extra_bits += std::uint64_t{times} * (coded.extra_bits + distance.extra_bits);
        });
      });
  counts[kEndOfBlock] = 1;
  const Codes codes(counts, distance.symbol, matches, extra_bits);
  if (codes.bits / 8 >= bytes()) return store(out, end);

  out.reserve(out.size() + codes.bits / 8 + 16);
  Bits bits(out);
  codes.write(bits, end == End::last);
  each_token(
      [&](std::span<const std::byte> bytes) {
        for (const std::byte byte : bytes) bits.add(codes.symbols[static_cast<std::size_t>(byte)]);
      },
      [&](auto, std::uint32_t run) {
        each_match(run, [&](std::uint32_t length, std::uint32_t times) {
          const Coded coded = coded_length(length);
          const HuffmanCode& code = codes.symbols[coded.symbol];
          for (; times > 0; --times) {
            bits.add(code);
            if (coded.extra_bits > 0) bits.add(coded.extra, coded.extra_bits);
            bits.add(0, 1);  // the only distance
            if (distance.extra_bits > 0) bits.add(distance.extra, distance.extra_bits);
          }
        });
      });
  bits.add(codes.symbols[kEndOfBlock]);
  if (end == End::more) bits.add(0, 3);  // an empty stored block, which begins with a byte
  bits.to_byte();
  if (end == End::more) out.append("\0\0\xFF\xFF", 4);
}

std::string RunDeflater::all() const {
  std::string bytes;
  bytes.reserve(this->bytes());
  each_token(
      [&](std::span<const std::byte> part) { bytes.append(reinterpret_cast<const char*>(part.data()), part.size()); },
      [&](std::span<const std::byte> element, std::uint32_t run) {
        for (std::uint32_t n = 0; n < run; n += static_cast<std::uint32_t>(period_))
          bytes.append(reinterpret_cast<const char*>(element.data()), element.size());
      });
  return bytes;
}

// As it is, in pieces whose lengths have 16 bits.
void RunDeflater::store(std::string& out, End end) const {
  const std::string bytes = all();
  for (std::size_t at = 0;;) {
    const std::size_t part = std::min<std::size_t>(bytes.size() - at, 0xFFFF);
    const bool last = end == End::last && at + part == bytes.size();
    out += last ? '\1' : '\0';
    for (const std::size_t number : {part, ~part}) {
      out += static_cast<char>(number & 0xFF);
      out += static_cast<char>(number >> 8 & 0xFF);
    }
    out.append(bytes, at, part);
    at += part;
    if (at == bytes.size()) return;
  }
}

std::string RunDeflater::zlib() const {
  std::string stream = "\x78\x01";  // a window of 32 KiB, packed fast
  deflate(stream, End::last);
  const std::uint32_t sum = adler32();
  for (int shift = 24; shift >= 0; shift -= 8) stream += static_cast<char>(sum >> shift & 0xFF);
  return stream;
}

std::string zlib_stream(std::string_view bytes) {
  RunDeflater deflater(1);
  deflater.elements(reinterpret_cast<const std::byte*>(bytes.data()), bytes.size());
  return deflater.zlib();
}

std::uint32_t RunDeflater::adler32() const {
  std::uint32_t sum = 1;
  each_token(
      [&](std::span<const std::byte> bytes) {
        sum = static_cast<std::uint32_t>(::adler32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
      },
      [&](std::span<const std::byte> element, std::uint32_t run) {
        sum = adler32_of_run(sum, element, run / element.size());
      });
  return sum;
}

std::uint32_t RunDeflater::crc32(const CrcRuns& runs) const {
  std::uint32_t crc = 0;
  each_token(
      [&](std::span<const std::byte> bytes) {
        crc = static_cast<std::uint32_t>(::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
      },
      [&](std::span<const std::byte> element, std::uint32_t run) {
        crc = runs.of_run(crc, element, run / element.size());
      });
  return crc;
}

}  // namespace standoff
