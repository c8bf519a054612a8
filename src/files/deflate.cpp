// SPDX-License-Identifier: Apache-2.0
#include "files/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

namespace standoff {
namespace {

// Both checksums are linear in what came before. Adler-32 has a closed form; the CRC of a run is looked up, and moved
// into place by a product of polynomials, as zlib's crc32_combine does.

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

// Table k: the CRC of a byte with k zero bytes behind it (Kounavis and Berry, "Novel table lookup-based algorithms for
// high-performance CRC generation", 2008).
constexpr auto kCrcTables = [] {
  std::array<std::array<std::uint32_t, 256>, 8> tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ (0xEDB88320 & (0u - (crc & 1)));
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < tables.size(); ++k)
    for (std::size_t byte = 0; byte < 256; ++byte)
      tables[k][byte] = (tables[k - 1][byte] >> 8) ^ tables[0][tables[k - 1][byte] & 0xFF];
  return tables;
}();

// From here on zlib is faster. It takes byte by byte what is shorter than 47 bytes, as most literals between runs are.
constexpr std::size_t kLongForCrc = 512;

std::uint32_t crc_of(std::uint32_t before, const void* bytes, std::size_t count) {
  const auto* at = static_cast<const unsigned char*>(bytes);
  if (count >= kLongForCrc) return static_cast<std::uint32_t>(::crc32_z(before, at, count));
  std::uint32_t crc = ~before;
  const auto& t = kCrcTables;
  for (; count >= 8; count -= 8, at += 8) {
    std::uint64_t word;
    std::memcpy(&word, at, sizeof word);
    word ^= crc;
    const auto byte = [word](int n) { return (word >> (8 * n)) & 0xFF; };
    crc = t[7][byte(0)] ^ t[6][byte(1)] ^ t[5][byte(2)] ^ t[4][byte(3)] ^  //
          t[3][byte(4)] ^ t[2][byte(5)] ^ t[1][byte(6)] ^ t[0][byte(7)];
  }
  for (; count > 0; --count, ++at) crc = (crc >> 8) ^ t[0][(crc ^ *at) & 0xFF];
  return ~crc;
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

// The prefix codes of deflate (RFC 1951, section 3.2.2).

namespace {

struct HuffmanCode {
  std::uint16_t bits = 0;   ///< as they are written: the first one lowest
  std::uint8_t length = 0;  ///< 0: the symbol does not occur
};

struct Symbol {
  std::uint32_t count;
  std::uint16_t symbol;
};

// Depths of the leaves of Huffman's tree, leaves in ascending order of their counts: two queues, of leaves and of the
// nodes made of them, whose counts ascend too.
std::vector<int> depths(const std::vector<Symbol>& leaves) {
  const std::size_t n = leaves.size();
  std::vector<std::uint64_t> count(2 * n - 1);
  std::vector<std::size_t> parent(2 * n - 1);
  for (std::size_t k = 0; k < n; ++k) count[k] = leaves[k].count;
  std::size_t leaf = 0, node = n;
  for (std::size_t made = n; made < 2 * n - 1; ++made)
    for (int child = 0; child < 2; ++child) {
      const bool take_leaf = leaf < n && (node == made || count[leaf] <= count[node]);
      const std::size_t least = take_leaf ? leaf++ : node++;
      count[made] += count[least];
      parent[least] = made;
    }
  std::vector<int> depth(2 * n - 1);
  for (std::size_t k = 2 * n - 2; k-- > 0;) depth[k] = depth[parent[k]] + 1;
  depth.resize(n);
  return depth;
}

std::uint16_t reversed(unsigned code, int length) {
  unsigned bits = 0;
  for (int n = 0; n < length; ++n) bits |= ((code >> n) & 1u) << (length - 1 - n);
  return static_cast<std::uint16_t>(bits);
}

// The codes of symbols that occur so often, none longer than `longest` bits. A single symbol gets one bit. Requires
// fewer than 2^longest symbols.
void make_huffman_codes(std::span<const std::uint32_t> counts, int longest, std::span<HuffmanCode> codes) {
  std::ranges::fill(codes, HuffmanCode{});
  std::vector<Symbol> leaves;
  for (std::size_t k = 0; k < counts.size(); ++k)
    if (counts[k] > 0) leaves.push_back({counts[k], static_cast<std::uint16_t>(k)});
  if (leaves.empty()) return;
  std::ranges::sort(leaves, [](const Symbol& a, const Symbol& b) {
    return a.count != b.count ? a.count < b.count : a.symbol < b.symbol;
  });
  if (leaves.size() == 1) {
    codes[leaves[0].symbol].length = 1;
  } else {
    // Counts that are alike make flat trees: they are halved until the deepest leaf is high enough.
    std::vector<int> depth = depths(leaves);
    while (*std::ranges::max_element(depth) > longest) {
      for (Symbol& leaf : leaves) leaf.count = leaf.count / 2 + 1;
      depth = depths(leaves);
    }
    for (std::size_t k = 0; k < leaves.size(); ++k)
      codes[leaves[k].symbol].length = static_cast<std::uint8_t>(depth[k]);
  }
  unsigned code = 0;
  for (int length = 1; length <= longest; ++length, code <<= 1)
    for (HuffmanCode& one : codes)
      if (one.length == length) one.bits = reversed(code++, length);
}

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
  each_token([&](std::span<const std::byte> bytes) { crc = crc_of(crc, bytes.data(), bytes.size()); },
             [&](std::span<const std::byte> element, std::uint32_t run) {
               crc = runs.of_run(crc, element, run / element.size());
             });
  return crc;
}

namespace {

// zlib counts what is left to read and to write in 32 bits.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
constexpr std::size_t kPiece = std::size_t{1} << 18;

struct DeflateStream {
  z_stream z{};
  explicit DeflateStream(int level) {
    const int begun = deflateInit(&z, level);
    if (begun == Z_MEM_ERROR) throw std::bad_alloc();
    if (begun != Z_OK) throw std::logic_error("deflateInit: " + std::to_string(begun));
  }
  DeflateStream(const DeflateStream&) = delete;
  DeflateStream& operator=(const DeflateStream&) = delete;
  ~DeflateStream() { deflateEnd(&z); }
};

}  // namespace

std::string zlib_packed(std::string_view bytes, int level) {
  DeflateStream stream(level);
  std::string packed;
  int state = Z_OK;
  while (state != Z_STREAM_END) {
    if (stream.z.avail_in == 0) {
      const std::string_view next = bytes.substr(0, kMostAtOnce);
      bytes.remove_prefix(next.size());
      stream.z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));
      stream.z.avail_in = static_cast<uInt>(next.size());
    }
    const std::size_t before = packed.size();
    packed.resize(before + kPiece);
    stream.z.next_out = reinterpret_cast<Bytef*>(packed.data() + before);
    stream.z.avail_out = static_cast<uInt>(kPiece);
    state = deflate(&stream.z, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
    if (state == Z_STREAM_ERROR) throw std::logic_error("deflate: the stream is broken");
    packed.resize(packed.size() - stream.z.avail_out);
  }
  return packed;
}

}  // namespace standoff
