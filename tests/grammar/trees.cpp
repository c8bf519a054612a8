// SPDX-License-Identifier: Apache-2.0
// VDB and NVDB: small fields as trees, with a single path from the root; leaves that are clamped may be left out.
#include <algorithm>
#include <array>
#include <cmath>

#include "tests/grammar/hostile.h"
#include "tests/grammar/packed.h"
#include "tests/grammar/shape.h"

namespace standoff::grammar {
namespace {

/// A field of less than 128 samples a side: leaves of one node.
struct TreeField {
  struct Leaf {
    std::size_t place;  ///< in its node, z fastest
    std::array<float, 512> values;
    std::array<bool, 512> active;
  };
  Truth truth;
  float background = 0;
  std::vector<Leaf> leaves;  ///< in the order of their places
};

TreeField make_tree_field(Choices& c) {
  TreeField tree;
  tree.truth = make_field(c, false);
  const Truth& field = tree.truth;
  const auto far = static_cast<float>(field.thickness);
  tree.background = std::isinf(far) ? 1000.0f : far;
  const Size3 size = field.grid.size;
  for (std::int64_t x = 0; x < size.x; x += 8)
    for (std::int64_t y = 0; y < size.y; y += 8)
      for (std::int64_t z = 0; z < size.z; z += 8) {
        TreeField::Leaf leaf{static_cast<std::size_t>((x / 8) << 8 | (y / 8) << 4 | z / 8), {}, {}};
        bool clamped = true;
        for (std::int64_t n = 0; n < 512; ++n) {
          const std::int64_t i = x + (n >> 6), j = y + (n >> 3 & 7), k = z + (n & 7);
          const bool in_grid = i < size.x && j < size.y && k < size.z;
          const float value = in_grid ? field.values[static_cast<std::size_t>(field.grid.index(i, j, k))] : far;
          const bool active = in_grid && std::abs(value) < far;
          leaf.active[static_cast<std::size_t>(n)] = active;
          leaf.values[static_cast<std::size_t>(n)] = active                 ? value
                                                     : in_grid && value < 0 ? -tree.background
                                                                            : tree.background;
          clamped = clamped && leaf.values[static_cast<std::size_t>(n)] == tree.background;
        }
        if (!clamped || c.one_in(4)) tree.leaves.push_back(leaf);
      }
  return tree;
}

std::string text(Choices& c, const std::string& words) {
  return raw(stored(c, static_cast<std::uint32_t>(words.size()))) + words;
}

class Vdb {
 public:
  explicit Vdb(Choices& c)
      : c_(c), tree_(make_tree_field(c)), flags_((c.one_in(3) ? 1u : 0u) | (c.one_in(3) ? 0u : 2u)) {}

  File make() {
    std::string bytes = raw(stored(c_, std::uint64_t{0x56444220})) + raw(stored(c_, std::uint32_t{222} + c_.below(3))) +
                        raw(std::uint64_t{10}) + raw(stored(c_, std::uint8_t{1})) + std::string(36, 'x');
    const std::uint32_t facts = c_.below(3);
    bytes += raw(stored(c_, facts));
    for (std::uint32_t n = 0; n < facts; ++n) bytes += fact("creator", "string", "nobody");
    bytes += raw(stored(c_, std::uint32_t{1}));
    bytes += text(c_, word(c_, "distance")) + text(c_, word(c_, "Tree_float_5_4_3")) + text(c_, c_.trick() ? "x" : "");
    const std::string front = grid_front(), topology = this->topology(), buffers = this->buffers();
    const std::uint64_t grid = bytes.size() + 24, blocks = grid + front.size() + topology.size();
    bytes += raw(stored(c_, grid)) + raw(stored(c_, blocks)) + raw(stored(c_, std::uint64_t{blocks + buffers.size()}));
    File made{bytes + front + topology + buffers, {}, tree_.truth};
    damage(c_, made.bytes);
    return made;
  }

 private:
  std::string fact(const std::string& name, const std::string& type, const std::string& value) {
    return text(c_, word(c_, name)) + text(c_, word(c_, type)) + text(c_, value);
  }
  std::string three(const Vec3& v) { return raw(stored(c_, v.x)) + raw(stored(c_, v.y)) + raw(stored(c_, v.z)); }

  std::string grid_front() {
    const Grid& grid = tree_.truth.grid;
    std::string size;
    for (const std::int64_t side : {grid.size.x, grid.size.y, grid.size.z})
      size += raw(stored(c_, static_cast<std::int32_t>(side)));
    std::string bytes = raw(stored(c_, flags_)) + raw(stored(c_, std::uint32_t{3}));
    bytes += fact("class", "string", "level set") + fact("standoff_size", "vec3i", size) +
             fact("standoff_thickness", "double", raw(stored(c_, tree_.truth.thickness)));
    bytes += text(c_, word(c_, "ScaleTranslateMap")) + three(grid.origin) + three(grid.spacing);
    for (int derived = 0; derived < 4; ++derived) bytes += three({1, 1, 1});
    return bytes;
  }

  std::string data(const std::string& bytes) {
    if (!(flags_ & 1)) return bytes;
    if (c_.one_in(3)) return raw(stored(c_, -static_cast<std::int64_t>(bytes.size()))) + bytes;
    const std::string packed = zlibbed(c_, bytes);
    return raw(stored(c_, static_cast<std::int64_t>(packed.size()))) + packed;
  }

  // The values of a node: those that are active, and how the others are found.
  std::string values(const float* values, const bool* active, std::size_t count) {
    std::string all, few, mask(count / 8, '\0');
    bool any_negative = false, any_background = false;
    for (std::size_t n = 0; n < count; ++n) {
      all += raw(values[n]);
      if (active[n]) {
        few += raw(stored(c_, values[n]));
        continue;
      }
      const bool background = values[n] == tree_.background;
      (background ? any_background : any_negative) = true;
      if (background) mask[n / 8] = static_cast<char>(mask[n / 8] | 1 << n % 8);
    }
    if (!(flags_ & 2) || c_.one_in(5)) return raw(stored(c_, std::uint8_t{6})) + data(all);
    if (any_negative && any_background) {
      if (c_.one_in(2)) return raw(std::uint8_t{3}) + mask + data(few);
      if (c_.one_in(2)) return raw(std::uint8_t{4}) + raw(stored(c_, -tree_.background)) + mask + data(few);
      return raw(std::uint8_t{5}) + raw(-tree_.background) + raw(stored(c_, tree_.background)) + mask + data(few);
    }
    if (any_negative) return raw(std::uint8_t{1}) + data(few);
    if (c_.one_in(4)) return raw(std::uint8_t{2}) + raw(tree_.background) + data(few);
    return raw(stored(c_, std::uint8_t{0})) + data(few);
  }

  std::string mask(const std::vector<std::size_t>& bits, std::size_t count) {
    std::string bytes(count / 8, '\0');
    for (const std::size_t n : bits) bytes[n / 8] = static_cast<char>(bytes[n / 8] | 1 << n % 8);
    if (c_.trick()) bytes[c_.below(static_cast<std::uint32_t>(bytes.size()))] = static_cast<char>(c_.below(256));
    return bytes;
  }
  static std::string mask_of(const TreeField::Leaf& leaf) {
    std::string bytes(64, '\0');
    for (std::size_t n = 0; n < 512; ++n)
      if (leaf.active[n]) bytes[n / 8] = static_cast<char>(bytes[n / 8] | 1 << n % 8);
    return bytes;
  }

  std::string inner(const std::vector<std::size_t>& children, std::size_t count) {
    const std::vector<float> all(count, tree_.background);
    const auto active = std::make_unique<bool[]>(count);
    return mask(children, count) + mask({}, count) + values(all.data(), active.get(), count);
  }

  std::string topology() {
    const bool empty = tree_.leaves.empty();
    std::string bytes = raw(stored(c_, std::uint32_t{1})) + raw(stored(c_, tree_.background)) +
                        raw(stored(c_, std::uint32_t{0})) + raw(stored(c_, empty ? 0u : 1u));
    if (empty) return bytes;
    for (int axis = 0; axis < 3; ++axis) bytes += raw(stored(c_, std::int32_t{0}));
    std::vector<std::size_t> places;
    for (const auto& leaf : tree_.leaves) places.push_back(leaf.place);
    bytes += inner({0}, 32768) + inner(places, 4096);
    for (const auto& leaf : tree_.leaves) bytes += mask_of(leaf);
    return bytes;
  }

  std::string buffers() {
    std::string bytes;
    for (const auto& leaf : tree_.leaves) bytes += mask_of(leaf) + values(leaf.values.data(), leaf.active.data(), 512);
    return bytes;
  }

  Choices& c_;
  TreeField tree_;
  std::uint32_t flags_;  // 1: zip, 2: values that are not active are left out
};

// Bytes of a structure, zero where nothing is put.
class Bytes {
 public:
  Bytes(Choices& c, std::size_t count) : c_(c), bytes(count, '\0') {}
  template <class T>
  void put(std::size_t at, T value) {
    const std::string some = raw(stored(c_, value));
    std::ranges::copy(some, bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }

 private:
  Choices& c_;

 public:
  std::string bytes;
};

}  // namespace

File make_vdb(Choices& c) { return Vdb(c).make(); }

File make_nvdb(Choices& c) {
  const TreeField tree = make_tree_field(c);
  const Grid& g = tree.truth.grid;
  const bool empty = tree.leaves.empty();
  const std::size_t root = 672 + 64, tile = root + 64, upper = tile + (empty ? 0 : 32), lower = upper + 270400,
                    leaves = lower + 33856, blind = empty ? upper : leaves + 2144 * tree.leaves.size();
  std::string facts = "size=" + whole(c, g.size.x) + " " + whole(c, g.size.y) + " " + whole(c, g.size.z) +
                      "\nthickness=" + real64(c, tree.truth.thickness) + "\n" + noise(c);
  facts.resize((facts.size() + 3) / 4 * 4);
  Bytes grid(c, blind + 288);
  grid.put(0, c.one_in(2) ? std::uint64_t{0x304244566f6e614e} : std::uint64_t{0x314244566f6e614e});
  grid.put(16, std::uint32_t{32} << 21);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.put(384 + 32 * axis, (&g.spacing.x)[axis]);
    grid.put(528 + 8 * axis, (&g.origin.x)[axis]);
  }
  grid.put(636, std::uint32_t{1});
  grid.put(640, std::uint64_t{blind});
  grid.put(648, std::uint32_t{1});
  grid.put(672 + 24, std::uint64_t{root - 672});
  grid.put(root + 24, empty ? 0u : 1u);
  grid.put(root + 28, tree.background);
  if (!empty) {
    grid.put(tile + 8, std::uint64_t{upper - root});
    const auto table = [&](std::size_t at, std::size_t masks, std::size_t count) {
      for (std::size_t n = 0; n < count; ++n) {
        const std::string value = raw(tree.background);
        std::ranges::copy(value, grid.bytes.begin() + static_cast<std::ptrdiff_t>(at + 64 + 2 * masks + 8 * n));
      }
    };
    const auto child = [&](std::size_t at, std::size_t masks, std::size_t place, std::uint64_t offset) {
      char& byte = grid.bytes[at + 32 + masks + place / 8];
      byte = static_cast<char>(byte | 1 << place % 8);
      grid.put(at + 64 + 2 * masks + 8 * place, offset);
    };
    table(upper, 4096, 32768);
    table(lower, 512, 4096);
    child(upper, 4096, 0, lower - upper);
    for (std::size_t n = 0; n < tree.leaves.size(); ++n) {
      const TreeField::Leaf& leaf = tree.leaves[n];
      const std::size_t at = leaves + 2144 * n;
      // At a trick two paths lead to one leaf.
      child(lower, 512, leaf.place, (c.trick() ? leaves : at) - lower);
      for (std::size_t k = 0; k < 512; ++k) {
        if (leaf.active[k]) grid.bytes[at + 16 + k / 8] = static_cast<char>(grid.bytes[at + 16 + k / 8] | 1 << k % 8);
        grid.put(at + 96 + 4 * k, leaf.values[k]);
      }
    }
  }
  grid.put(blind, std::uint64_t{288});
  grid.put(blind + 8, std::uint64_t{facts.size() / 4});
  const std::string name = word(c, "standoff");
  std::copy_n(name.begin(), std::min<std::size_t>(name.size(), 255),
              grid.bytes.begin() + static_cast<std::ptrdiff_t>(blind + 32));
  grid.bytes += facts;

  const bool zip = c.one_in(3);
  std::string body = grid.bytes;
  if (zip) {
    body = zlibbed(c, grid.bytes);
    body = raw(stored(c, std::uint64_t{body.size()})) + body;
  }
  const std::string grid_name = word(c, "distance") + '\0';
  Bytes front(c, 16 + 176);
  front.put(0, std::uint64_t{0x304244566f6e614e});
  front.put(8, std::uint32_t{32} << 21);
  front.put(12, std::uint16_t{1});
  front.put(14, static_cast<std::uint16_t>(zip ? 1 : 0));
  front.put(16, std::uint64_t{grid.bytes.size()});
  front.put(24, std::uint64_t{body.size()});
  front.put(16 + 32, std::uint32_t{1});
  front.put(16 + 136, static_cast<std::uint32_t>(grid_name.size()));
  File made{front.bytes + grid_name + body, {}, tree.truth};
  damage(c, made.bytes);
  return made;
}

}  // namespace standoff::grammar
