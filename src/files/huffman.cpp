// SPDX-License-Identifier: Apache-2.0
// The prefix codes of deflate (RFC 1951, section 3.2.2).

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace standoff {
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

}  // namespace

}  // namespace standoff
