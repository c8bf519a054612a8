// SPDX-License-Identifier: Apache-2.0
// What is deflated as runs is what zlib inflates, and checksums are zlib's.
#include <gtest/gtest.h>

#include <zlib.h>

#include <random>

#include "files/deflate.h"

namespace standoff {
namespace {

std::string inflated(const std::string& packed, int window, std::size_t bytes) {
  std::string out(bytes + 1, '\0');
  z_stream stream{};
  EXPECT_EQ(::inflateInit2(&stream, window), Z_OK);
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(::inflate(&stream, Z_FINISH), Z_STREAM_END);
  EXPECT_EQ(stream.avail_in, 0u);
  out.resize(stream.total_out);
  ::inflateEnd(&stream);
  return out;
}

const std::byte* bytes(const std::string& text) { return reinterpret_cast<const std::byte*>(text.data()); }

// Added to a deflater, and as plain bytes.
struct Both {
  RunDeflater deflater;
  std::string plain;
  std::size_t period;

  explicit Both(std::size_t element_bytes) : deflater(element_bytes), period(element_bytes) {}
  void run(const std::string& element, std::uint64_t count) {
    deflater.run(bytes(element), count);
    for (; count > 0; --count) plain += element;
  }
  void elements(const std::string& some) {
    deflater.elements(bytes(some), some.size() / period);
    plain += some;
  }
  void expect_same() const {
    ASSERT_EQ(deflater.bytes(), plain.size());
    EXPECT_TRUE(inflated(deflater.zlib(), MAX_WBITS, plain.size()) == plain);
    std::string parts;
    deflater.deflate(parts, RunDeflater::End::more);
    deflater.deflate(parts, RunDeflater::End::last);
    EXPECT_TRUE(inflated(parts, -MAX_WBITS, 2 * plain.size()) == plain + plain);
    const auto* data = reinterpret_cast<const Bytef*>(plain.data());
    EXPECT_EQ(deflater.adler32(), ::adler32_z(1, data, plain.size()));
    const CrcRuns runs(period, plain.size() / period);
    const auto crc = static_cast<std::uint32_t>(::crc32_z(0, data, plain.size()));
    EXPECT_EQ(deflater.crc32(runs), crc);
    EXPECT_EQ(runs.joined(crc, crc, plain.size() / period), ::crc32_z(crc, data, plain.size()));
  }
};

TEST(Checksums, OfBytesOfAnyLength) {
  std::mt19937 random(5);
  std::string text;
  for (int n = 0; n < 1000; ++n) text += static_cast<char>(random());
  for (std::size_t begin = 0; begin < 20; ++begin)
    for (std::size_t count = 0; begin + count <= text.size(); count += count < 300 ? 1 : 97) {
      const std::string part = text.substr(begin, count);
      const auto before = static_cast<std::uint32_t>(random());
      ASSERT_EQ(crc32_of(before, std::as_bytes(std::span(part))),
                ::crc32_z(before, reinterpret_cast<const Bytef*>(part.data()), part.size()))
          << begin << " " << count;
    }
}

TEST(RunDeflate, RunsOfAnyLengthAndPeriod) {
  for (const std::size_t period : {1, 2, 3, 4, 12, 256}) {
    std::mt19937 random(7);
    const auto element = [&] {
      std::string text;
      for (std::size_t n = 0; n < period; ++n) text += static_cast<char>(random() % 200);
      return text;
    };
    const std::string known = element(), other = element();
    Both both(period);
    for (std::uint64_t n = 0; n < 600; ++n) {
      both.run(n % 3 ? known : other, n);
      both.run(element(), random() % 3);
      std::string some;
      for (auto k = random() % 20; k > 0; --k) some += element();
      both.elements(some);
    }
    both.run(known, 1'000'000 / period + 5);
    both.expect_same();
    EXPECT_LT(both.deflater.zlib().size(), both.plain.size() * 2 / 3);
  }
}

TEST(RunDeflate, NoiseIsStored) {
  Both both(4);
  std::mt19937 random(3);
  std::string noise;
  for (int n = 0; n < 200'000; ++n) noise += static_cast<char>(random());
  both.elements(noise);
  both.expect_same();
  EXPECT_LT(both.deflater.zlib().size(), noise.size() + 100);
}

TEST(RunDeflate, FewBytes) {
  for (const std::string text : {"a", "aa", "aaa", "aaaaa", "ab", "abcabc"}) {
    Both both(1);
    both.elements(text);
    both.expect_same();
  }
}

// Counts that grow as Fibonacci's numbers make the deepest tree.
TEST(RunDeflate, CodesAreNeverTooLong) {
  Both both(1);
  std::string text;
  for (unsigned a = 1, b = 1, letter = 0; letter < 28; ++letter) {
    for (unsigned n = 0; n < a; ++n) (text += static_cast<char>(letter)) += static_cast<char>(100 + n % 2);
    b += a;
    a = b - a;
  }
  both.elements(text);
  both.expect_same();
}

TEST(RunDeflate, ForgetsWhatWasBefore) {
  Both both(4);
  both.deflater.run(bytes("abcd"), 7);
  both.deflater.clear();
  both.run("abcd", 9);
  both.expect_same();
}

}  // namespace
}  // namespace standoff
