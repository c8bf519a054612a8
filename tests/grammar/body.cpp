// SPDX-License-Identifier: Apache-2.0
// Bodies: those of tests/corpus/body with parts replaced, and a checksum that fits, or nothing past it would be read.
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/grammar/file.h"
#include "tests/grammar/hostile.h"
#include "tests/support/paths.h"

namespace standoff::grammar {
namespace {

constexpr std::size_t kHeader = 72, kClosed = 12, kCounts = 16, kSpacing = 56, kComponents = 64;

std::string body(const char* name) {
  std::ifstream file(std::filesystem::path(kSourceFolder) / "tests/corpus/body" / name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// As src/collision/body/body.cpp sums: over the header and each array, eight bytes at a time and the rest.
class Checksum {
 public:
  void add(std::string_view bytes) {
    for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
      std::uint64_t word;
      std::memcpy(&word, bytes.data(), 8);
      mix(word);
    }
    std::uint64_t word = bytes.size();
    for (const char byte : bytes) word = word << 8 | static_cast<unsigned char>(byte);
    mix(word);
  }
  std::uint64_t value() const { return hash_; }

 private:
  void mix(std::uint64_t word) {
    hash_ = (hash_ ^ word) * 0xbf58476d1ce4e5b9u;
    hash_ ^= hash_ >> 29;
  }
  std::uint64_t hash_ = 0x9e3779b97f4a7c15u;
};

template <class T>
T number_at(const std::string& bytes, std::size_t at) {
  T number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}
template <class T>
void spoil(Choices& c, std::string& bytes, std::size_t at) {
  if (at + sizeof(T) > bytes.size()) return;
  const T number = stored(c, number_at<T>(bytes, at));
  std::memcpy(bytes.data() + at, &number, sizeof number);
}

}  // namespace

File make_body(Choices& c) {
  static const std::string kBodies[] = {body("triangle.body"), body("strip.body"), body("box.body")};
  const std::string& base = c.pick(kBodies);
  File file;
  std::string bytes = base.substr(0, base.size() - sizeof(std::uint64_t));
  // vertices, triangles, the tree's order, tiles' places, samples, the coarse field, components, and one bit for each
  // sample of both fields, if the body is closed
  constexpr std::size_t kArrays = 9;
  const std::size_t widths[kArrays] = {24, 12, 4, 4, 1, 4, 4, 1, 1};
  const auto count_of = [&bytes](std::size_t array) -> std::uint64_t {
    constexpr std::size_t counted[] = {0, 1, 1, 2, 3, 4, 6, 3, 4};  // the double of the spacing has the place of 5
    static_assert(kCounts + 8 * 5 == kSpacing && kCounts + 8 * 6 == kComponents);
    const auto count = number_at<std::uint64_t>(bytes, kCounts + 8 * counted[array]);
    if (array < 7) return count;
    return number_at<std::uint32_t>(bytes, kClosed) != 0 ? count / 8 + (count % 8 != 0) : 0;
  };
  std::size_t counts[kArrays];
  for (std::size_t k = 0; k < kArrays; ++k) counts[k] = count_of(k);
  std::vector<std::size_t> ends{kHeader};
  for (std::size_t k = 0; k < kArrays; ++k) ends.push_back(ends.back() + counts[k] * widths[k]);
  for (std::size_t t = 0; t < counts[1]; ++t) {
    Corners corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners[k] = number_at<Vec3>(bytes, ends[0] + 24 * number_at<std::uint32_t>(bytes, ends[1] + 12 * t + 4 * k));
    file.truth.triangles.push_back(corners);
  }
  for (std::size_t at = 8; at < kCounts; at += 4) spoil<std::uint32_t>(c, bytes, at);
  for (std::size_t k = 0; k < 5; ++k) spoil<std::uint64_t>(c, bytes, kCounts + 8 * k);
  spoil<double>(c, bytes, kSpacing);
  spoil<std::uint64_t>(c, bytes, kComponents);
  const auto somewhere = [&](std::size_t array) {
    return ends[array] + widths[array] * c.below(static_cast<std::uint32_t>(std::max<std::size_t>(counts[array], 1)));
  };
  for (int n = 0; n < 4; ++n) {
    spoil<double>(c, bytes, somewhere(0) + 8 * c.below(3));
    spoil<std::uint32_t>(c, bytes, somewhere(1) + 4 * c.below(3));
    spoil<std::uint32_t>(c, bytes, somewhere(2));
    spoil<std::int32_t>(c, bytes, somewhere(3));
    spoil<std::uint8_t>(c, bytes, somewhere(4));
    spoil<float>(c, bytes, somewhere(5));
    spoil<std::uint32_t>(c, bytes, somewhere(6));
    spoil<std::uint8_t>(c, bytes, somewhere(7));
    spoil<std::uint8_t>(c, bytes, somewhere(8));
  }
  // Of the arrays as the header now counts them: those are summed one by one.
  Checksum sum;
  std::string_view rest = bytes;
  const auto take = [&](std::size_t size) {
    sum.add(rest.substr(0, size));
    rest.remove_prefix(std::min(size, rest.size()));
  };
  take(kHeader);
  const std::size_t arrays = number_at<std::uint32_t>(bytes, kClosed) != 0 ? kArrays : kArrays - 2;
  for (std::size_t k = 0; k < arrays; ++k) take(widths[k] * count_of(k));
  file.bytes = bytes + raw(stored(c, sum.value()));
  damage(c, file.bytes);
  return file;
}

}  // namespace standoff::grammar
