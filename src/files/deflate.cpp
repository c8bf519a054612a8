// SPDX-License-Identifier: Apache-2.0
#include "files/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

namespace standoff {

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

// Bits at the end of a text, which gets room for all of them first.
class Bits {
 public:
  Bits(std::string& out, std::uint64_t most) : out_(out) {
    const std::size_t before = out.size();
    out.resize(before + most / 8 + 1 + sizeof held_);  // whole words are written
    at_ = out.data() + before;
  }

  static constexpr std::uint32_t kMostAtOnce = 56;
  void add(std::uint64_t bits, std::uint32_t count) {
    held_ |= bits << held_count_;
    held_count_ += count;
    std::memcpy(at_, &held_, sizeof held_);
    at_ += held_count_ / 8;
    held_ >>= held_count_ & ~7u;
    held_count_ &= 7;
  }
  void add(const HuffmanCode& code) { add(code.bits, code.length); }
  // Ends the text after the last bit's byte.
  void end() { out_.resize(static_cast<std::size_t>(at_ + (held_count_ > 0 ? 1 : 0) - out_.data())); }

 private:
  std::string& out_;
  char* at_ = nullptr;
  std::uint64_t held_ = 0;
  std::uint32_t held_count_ = 0;
};

// Samples have four bytes, which are coded together: two by two, and all at once where their bits fit.
constexpr std::size_t kBytesAtOnce = 4;
static_assert(2 * kLongestCode <= Bits::kMostAtOnce);

struct TwoCodes {
  std::uint64_t bits;
  std::uint32_t length;
  TwoCodes(const HuffmanCode& a, const HuffmanCode& b)
      : bits(a.bits | std::uint64_t{b.bits} << a.length), length(std::uint32_t{a.length} + b.length) {}
};

void write_literals(std::span<const std::byte> bytes, std::span<const HuffmanCode> codes, Bits& out) {
  const auto code = [&](std::size_t n) -> const HuffmanCode& { return codes[static_cast<std::size_t>(bytes[n])]; };
  std::size_t n = 0;
  for (; n + kBytesAtOnce <= bytes.size(); n += kBytesAtOnce) {
    const TwoCodes first(code(n), code(n + 1)), second(code(n + 2), code(n + 3));
    if (first.length + second.length <= Bits::kMostAtOnce) {
      out.add(first.bits | second.bits << first.length, first.length + second.length);
    } else {
      out.add(first.bits, first.length);
      out.add(second.bits, second.length);
    }
  }
  for (; n < bytes.size(); ++n) out.add(code(n));
}

// How often each byte occurs. Neighbours are counted apart: a counter that was just written is slow to read.
class ByteCounts {
 public:
  void add(std::span<const std::byte> bytes) {
    std::size_t n = 0;
    for (; n + kBytesAtOnce <= bytes.size(); n += kBytesAtOnce)
      for (std::size_t k = 0; k < kBytesAtOnce; ++k) ++counts_[k][static_cast<std::size_t>(bytes[n + k])];
    for (; n < bytes.size(); ++n) ++counts_[0][static_cast<std::size_t>(bytes[n])];
  }
  std::uint32_t of(std::size_t byte) const {
    std::uint32_t sum = 0;
    for (const auto& counts : counts_) sum += counts[byte];
    return sum;
  }

 private:
  std::array<std::array<std::uint32_t, kEndOfBlock>, kBytesAtOnce> counts_{};
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

void RunDeflater::add_literals(const std::byte* from, std::uint64_t count) {
  if (tokens_.empty() || tokens_.back().run > 0) tokens_.emplace_back();
  tokens_.back().literals += static_cast<std::uint32_t>(count * period_);
  literals_.insert(literals_.end(), from, from + count * period_);
}

void RunDeflater::add_run(std::uint64_t count) {
  tokens_.back().run += static_cast<std::uint32_t>(count * period_);
  run_bytes_ += count * period_;
}

template <std::size_t bytes>
void RunDeflater::add_elements(const std::byte* from, std::uint64_t count) {
  const std::size_t period = bytes > 0 ? bytes : period_;
  const auto repeats = [&](const std::byte* at, const std::byte* before) {
    return std::memcmp(at, before, period) == 0;
  };
  while (count > 0) {
    const bool is_run = !literals_.empty() && repeats(from, literals_.data() + literals_.size() - period);
    std::uint64_t n = 1;
    while (n < count && repeats(from + n * period, from + (n - 1) * period) == is_run) ++n;
    if (is_run)
      add_run(n);
    else
      add_literals(from, n);
    from += n * period;
    count -= n;
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
  ByteCounts byte_counts;
  std::array<std::uint32_t, kSymbols> counts{};
  std::uint64_t matches = 0, extra_bits = 0;
  const Coded distance = coded_distance(static_cast<std::uint32_t>(period_));
  each_token([&](std::span<const std::byte> bytes) { byte_counts.add(bytes); },
             [&](auto, std::uint32_t run) {
               each_match(run, [&](std::uint32_t length, std::uint32_t times) {
                 const Coded coded = coded_length(length);
                 counts[coded.symbol] += times;
                 matches += times;
                 extra_bits += std::uint64_t{times} * (coded.extra_bits + distance.extra_bits);
               });
             });
  for (std::size_t byte = 0; byte < kEndOfBlock; ++byte) counts[byte] = byte_counts.of(byte);
  counts[kEndOfBlock] = 1;
  const Codes codes(counts, distance.symbol, matches, extra_bits);
  if (codes.bits / 8 >= bytes()) return store(out, end);

  constexpr std::uint64_t kEndBits = 3;
  Bits bits(out, codes.bits + kEndBits);
  codes.write(bits, end == End::last);
  each_token([&](std::span<const std::byte> bytes) { write_literals(bytes, codes.symbols, bits); },
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
  if (end == End::more) bits.add(0, kEndBits);  // an empty stored block, which begins with a byte
  bits.end();
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
  each_token([&](std::span<const std::byte> bytes) { crc = crc32_of(crc, bytes); },
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
