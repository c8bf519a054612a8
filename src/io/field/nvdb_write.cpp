// SPDX-License-Identifier: Apache-2.0
// NVDB: NanoVDB's files, of its ABI 32: a header, and a grid as it lies in memory: root, upper nodes, lower nodes,
// leaves. What NanoVDB has no place for follows as blind data.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/text.h"
#include "io/field/nvdb_format.h"
#include "io/field/vdb_tree.h"

namespace standoff {
namespace {

using namespace vdb;

// The bytes of a structure, zero where nothing is put.
class NvdbRecord {
 public:
  explicit NvdbRecord(std::uint64_t bytes) : bytes_(bytes, '\0') {}

  template <class Value>
  void put(std::uint64_t at, const Value& value) {
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  void put_text(std::uint64_t at, std::string_view text) { std::copy(text.begin(), text.end(), bytes_.data() + at); }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

// What is active in a node.
struct Active {
  std::array<std::int32_t, 3> min, max;
  float least = std::numeric_limits<float>::max(), most = std::numeric_limits<float>::lowest();
  std::uint64_t samples = 0;

  Active() {
    min.fill(std::numeric_limits<std::int32_t>::max());
    max.fill(std::numeric_limits<std::int32_t>::min());
  }
  void add(const Active& other) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      min[axis] = std::min(min[axis], other.min[axis]);
      max[axis] = std::max(max[axis], other.max[axis]);
    }
    least = std::min(least, other.least);
    most = std::max(most, other.most);
    samples += other.samples;
  }
};

std::array<std::int32_t, 3> coordinates(const Size3& at) {
  return {static_cast<std::int32_t>(at.x), static_cast<std::int32_t>(at.y), static_cast<std::int32_t>(at.z)};
}

Active active_in(const Tree::Leaf& leaf, const LeafMasks& found) {
  Active active;
  // A word holds a slice of x: 8 rows of y, of 8 bits of z.
  std::uint64_t slices = 0, x_first = 8, x_last = 0;
  for (std::uint64_t x = 0; x < 8; ++x) {
    const std::uint64_t word = found.active.words[x];
    if (word == 0) continue;
    slices |= word;
    x_first = std::min(x_first, x);
    x_last = x;
    active.samples += static_cast<std::uint64_t>(std::popcount(word));
  }
  if (active.samples == 0) return active;
  std::uint64_t z_bits = 0;
  for (int y = 0; y < 8; ++y) z_bits |= slices >> 8 * y & 0xFF;
  const std::array<std::uint64_t, 3> first{x_first, static_cast<std::uint64_t>(std::countr_zero(slices)) / 8,
                                           static_cast<std::uint64_t>(std::countr_zero(z_bits))};
  const std::array<std::uint64_t, 3> last{x_last, (63 - static_cast<std::uint64_t>(std::countl_zero(slices))) / 8,
                                          63 - static_cast<std::uint64_t>(std::countl_zero(z_bits))};
  const auto origin = coordinates(leaf.at);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    active.min[axis] = origin[axis] + static_cast<std::int32_t>(first[axis]);
    active.max[axis] = origin[axis] + static_cast<std::int32_t>(last[axis]);
  }
  active.least = found.least, active.most = found.most;
  return active;
}

std::uint64_t name_key(std::string_view name) {  // as NanoVDB's stringHash
  std::uint64_t hash = 0;
  for (const char c : name) {
    const auto overflow = hash >> 57;
    hash = hash * 67 + static_cast<std::uint64_t>(c) + overflow;
  }
  return hash;
}

class NvdbWriter {
 public:
  NvdbWriter(AtomicFile& file, const DistanceField& field, int threads)
      : file_(file),
        field_(field),
        threads_(threads),
        tree_(tree_of(field, file)),
        far_(background_of(field)),
        facts_(facts()) {}

  void write() {
    find_active();
    write_header();
    write_grid();
    write_root();
    for (std::size_t n = 0; n < tree_.uppers.size(); ++n)
      write_inner(tree_.uppers[n], uppers_[n], n, tree_.uppers.size(), nvdb::Inner<kLowerLog>::kBytes);
    for (std::size_t n = 0; n < tree_.lowers.size(); ++n)
      write_inner(tree_.lowers[n], lowers_[n], n, tree_.lowers.size(), nvdb::leaf::kBytes);
    write_leaves(file_, tree_, threads_, nvdb::leaf::kBytes, [&](std::size_t n, char* to) { return make_leaf(n, to); });
    write_blind();
  }

 private:
  void raw(std::string_view bytes) { file_.write(bytes.data(), bytes.size()); }

  // Of all nodes, before the first one is written: an inner node says what its children hold.
  void find_active() {
    leaves_.resize(tree_.leaves.size());
    masks_.resize(tree_.leaves.size());
    each_leaf(tree_, threads_, [&](std::size_t n) {
      if (n % 1024 == 0) file_.check();
      fetch_leaf_after(field_, tree_, n);
      const LeafMasks found = leaf_masks(field_, tree_.leaves[n]);
      leaves_[n] = active_in(tree_.leaves[n], found);
      masks_[n] = found.active;
    });
    uppers_.resize(tree_.uppers.size());
    lowers_.resize(tree_.lowers.size());
    for (std::size_t upper = 0; upper < uppers_.size(); ++upper) {
      const auto& node = tree_.uppers[upper];
      for (std::size_t lower = node.first; lower < node.first + node.count; ++lower) {
        const auto& leaves = tree_.lowers[lower];
        for (std::size_t n = leaves.first; n < leaves.first + leaves.count; ++n) lowers_[lower].add(leaves_[n]);
        uppers_[upper].add(lowers_[lower]);
      }
      all_.add(uppers_[upper]);
    }
  }

  std::string facts() const {
    const Size3& size = field_.grid().size;
    const Provenance& from = field_.provenance();
    std::string text = "size=" + std::to_string(size.x) + " " + std::to_string(size.y) + " " + std::to_string(size.z) +
                       "\nthickness=" + exact_text(field_.thickness()) + "\nmethod=" + escaped(from.method) +
                       "\nmesh_hash=" + hash_text(from.mesh_hash) + "\nversion=" + escaped(from.version) +
                       "\nsign=" + escaped(from.sign) + "\n" + (from.up ? "up=" + axis_text(from.up) + "\n" : "");
    constexpr std::size_t kAligned = 32;
    text.append((kAligned - text.size() % kAligned) % kAligned, '\0');
    return text;
  }

  std::size_t table_size() const { return tree_.uppers.size() + tree_.inside.size(); }
  // From the beginning of the grid.
  std::uint64_t root_at() const { return nvdb::grid::kBytes + nvdb::tree::kBytes; }
  std::uint64_t uppers_at() const { return root_at() + nvdb::root::kBytes + nvdb::root::kTileBytes * table_size(); }
  std::uint64_t lowers_at() const { return uppers_at() + nvdb::Inner<kUpperLog>::kBytes * tree_.uppers.size(); }
  std::uint64_t leaves_at() const { return lowers_at() + nvdb::Inner<kLowerLog>::kBytes * tree_.lowers.size(); }
  std::uint64_t blind_at() const { return leaves_at() + nvdb::leaf::kBytes * tree_.leaves.size(); }
  std::uint64_t grid_bytes() const { return blind_at() + nvdb::blind::kBytes + facts_.size(); }

  std::array<double, 6> world_box() const {
    const Grid& grid = field_.grid();
    if (all_.samples == 0) return {};
    const Vec3 first = grid.position(all_.min[0], all_.min[1], all_.min[2]),
               last = grid.position(all_.max[0] + std::int64_t{1}, all_.max[1] + std::int64_t{1},
                                    all_.max[2] + std::int64_t{1});
    return {first.x, first.y, first.z, last.x, last.y, last.z};
  }
  std::array<double, 3> voxel_size() const {
    const Vec3& h = field_.grid().spacing;
    return {h.x, h.y, h.z};
  }
  std::uint32_t grid_class() const { return field_.has_sign() ? nvdb::kLevelSet : 0; }
  std::array<std::uint32_t, 3> node_counts() const {
    return {static_cast<std::uint32_t>(tree_.leaves.size()), static_cast<std::uint32_t>(tree_.lowers.size()),
            static_cast<std::uint32_t>(tree_.uppers.size())};
  }

  void write_header() {
    namespace f = nvdb::file;
    const std::string name = std::string(kName) + '\0';
    NvdbRecord header(f::kHeaderBytes), meta(f::kMetaBytes);
    header.put(0, nvdb::kMagic);
    header.put(8, nvdb::kVersion);
    header.put(f::kGridCount, std::uint16_t{1});
    header.put(f::kCodec, nvdb::Codec::none);
    meta.put(f::kGridSize, grid_bytes());
    meta.put(f::kFileSize, grid_bytes());
    meta.put(f::kNameKey, name_key(kName));
    meta.put(f::kVoxelCount, all_.samples);
    meta.put(f::kType, nvdb::kFloat);
    meta.put(f::kClass, grid_class());
    meta.put(f::kWorldBox, world_box());
    meta.put(f::kIndexBox, all_.min);
    meta.put(f::kIndexBox + 12, all_.max);
    meta.put(f::kVoxelSize, voxel_size());
    meta.put(f::kNameSize, static_cast<std::uint32_t>(name.size()));
    meta.put(f::kNodeCount, node_counts());
    meta.put(f::kNodeCount + 12, std::uint32_t{1});
    meta.put(f::kMetaCodec, nvdb::Codec::none);
    meta.put(f::kMetaVersion, nvdb::kVersion);
    raw(header.bytes());
    raw(meta.bytes());
    raw(name);
  }

  void write_grid() {
    namespace g = nvdb::grid;
    const Vec3 h = field_.grid().spacing, o = field_.grid().corner();
    NvdbRecord grid(g::kBytes), tree(nvdb::tree::kBytes);
    grid.put(0, nvdb::kMagic);
    grid.put(g::kChecksum, ~std::uint64_t{0});  // none
    grid.put(g::kVersionAt, nvdb::kVersion);
    grid.put(g::kFlags, g::kHasBox | g::kHasMinMax | g::kBreadthFirst);
    grid.put(g::kCount, std::uint32_t{1});
    grid.put(g::kSize, grid_bytes());
    grid.put_text(g::kName, kName);
    const std::array<double, 9> matrix{h.x, 0, 0, 0, h.y, 0, 0, 0, h.z};
    const std::array<double, 9> inverse{1 / h.x, 0, 0, 0, 1 / h.y, 0, 0, 0, 1 / h.z};
    const std::array<double, 3> vector{o.x, o.y, o.z};
    const auto put_both = [&](std::uint64_t at_float, std::uint64_t at, const auto& numbers) {
      for (std::size_t n = 0; n < numbers.size(); ++n) grid.put(at_float + 4 * n, static_cast<float>(numbers[n]));
      grid.put(at, numbers);
    };
    put_both(g::kMatrixF, g::kMatrix, matrix);
    put_both(g::kInverseF, g::kInverse, inverse);
    put_both(g::kVectorF, g::kVector, vector);
    put_both(g::kTaperF, g::kTaper, std::array<double, 1>{1});
    grid.put(g::kWorldBox, world_box());
    grid.put(g::kVoxelSize, voxel_size());
    grid.put(g::kClass, grid_class());
    grid.put(g::kType, nvdb::kFloat);
    grid.put(g::kBlindOffset, blind_at());
    grid.put(g::kBlindCount, std::uint32_t{1});
    const std::uint64_t tree_at = g::kBytes;
    tree.put(nvdb::tree::kNodeOffset, std::array<std::uint64_t, 4>{leaves_at() - tree_at, lowers_at() - tree_at,
                                                                   uppers_at() - tree_at, root_at() - tree_at});
    tree.put(nvdb::tree::kNodeCount, node_counts());
    tree.put(nvdb::tree::kVoxelCount, all_.samples);
    raw(grid.bytes());
    raw(tree.bytes());
  }

  void put_range(NvdbRecord& node, std::uint64_t at, const Active& active) const {
    node.put(at, active.samples > 0 ? active.least : far_);
    node.put(at + 4, active.samples > 0 ? active.most : far_);
  }

  void write_root() {
    namespace r = nvdb::root;
    NvdbRecord root(r::kBytes);
    root.put(0, all_.min);
    root.put(12, all_.max);
    root.put(r::kTableSize, static_cast<std::uint32_t>(table_size()));
    root.put(r::kBackground, far_);
    put_range(root, r::kMinimum, all_);
    raw(root.bytes());
    // In ascending order of their keys, as some readers search for them.
    std::vector<std::pair<std::uint64_t, std::int64_t>> tiles;  // key, and number of the upper node
    const auto key = [](const Size3& at) {
      return static_cast<std::uint64_t>(at.z / kUpperSide) | static_cast<std::uint64_t>(at.y / kUpperSide) << 21 |
             static_cast<std::uint64_t>(at.x / kUpperSide) << 42;
    };
    for (std::size_t n = 0; n < tree_.uppers.size(); ++n)
      tiles.emplace_back(key(tree_.uppers[n].at), static_cast<std::int64_t>(n));
    for (const Size3& at : tree_.inside) tiles.emplace_back(key(at), -1);
    std::ranges::sort(tiles);
    for (const auto& [tile_key, upper] : tiles) {
      NvdbRecord tile(r::kTileBytes);
      tile.put(0, tile_key);
      if (upper >= 0)
        tile.put(r::kChild, static_cast<std::int64_t>(uppers_at() - root_at()) +
                                upper * static_cast<std::int64_t>(nvdb::Inner<kUpperLog>::kBytes));
      tile.put(r::kValue, upper >= 0 ? 0.0f : -far_);
      raw(tile.bytes());
    }
  }

  // Number `n` of `count` nodes of its level, whose children follow the last of them.
  template <int log>
  void write_inner(const Node<log>& node, const Active& active, std::size_t n, std::size_t count,
                   std::uint64_t child_bytes) {
    using N = nvdb::Inner<log>;
    NvdbRecord record(N::kBytes);
    // A node's place is that of its box, also where nothing is active.
    const auto origin = coordinates(node.at);
    record.put(0, active.samples > 0 ? active.min : origin);
    record.put(12, active.samples > 0 ? active.max : origin);
    record.put(N::kChildMask, node.child.words);
    put_range(record, N::kMinimum, active);
    std::uint64_t child = N::kBytes * (count - n) + child_bytes * node.first;
    for (std::size_t k = 0; k < Mask<log>::kBits; ++k) {
      if (node.child[k]) {
        record.put(N::kTable + 8 * k, child);
        child += child_bytes;
      } else {
        record.put(N::kTable + 8 * k, node.inside[k] ? -far_ : far_);
      }
    }
    raw(record.bytes());
  }

  std::size_t make_leaf(std::size_t n, char* to) const {
    namespace l = nvdb::leaf;
    const Tree::Leaf& leaf = tree_.leaves[n];
    std::array<float, 512> values;
    fetch_leaf_after(field_, tree_, n);
    leaf_values(field_, leaf, far_, values);
    const Active& active = leaves_[n];
    std::fill_n(to, l::kValues, '\0');
    const auto put = [&](std::uint64_t at, const auto& value) { std::memcpy(to + at, &value, sizeof value); };
    put(l::kBoxMin, active.samples > 0 ? active.min : coordinates(leaf.at));
    if (active.samples > 0) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        put(l::kBoxSpan + axis, static_cast<std::uint8_t>(active.max[axis] - active.min[axis]));
      put(l::kFlags, std::uint8_t{2});  // it has a box
    }
    put(l::kMask, masks_[n].words);
    put(l::kMinimum, active.samples > 0 ? active.least : far_);
    put(l::kMaximum, active.samples > 0 ? active.most : far_);
    put(l::kValues, values);
    return l::kBytes;
  }

  void write_blind() {
    namespace b = nvdb::blind;
    constexpr std::uint32_t kUint32 = 10;
    NvdbRecord blind(b::kBytes);
    blind.put(b::kOffset, b::kBytes);
    blind.put(b::kElements, std::uint64_t{facts_.size() / 4});
    blind.put(b::kDataType, kUint32);
    blind.put_text(b::kName, nvdb::kFacts);
    raw(blind.bytes());
    raw(facts_);
  }

  static constexpr std::string_view kName = "distance";

  AtomicFile& file_;
  const DistanceField& field_;
  const int threads_;
  const Tree tree_;
  const float far_;
  const std::string facts_;
  std::vector<Active> uppers_, lowers_, leaves_;
  std::vector<Mask<kLeafLog>> masks_;  // of leaves
  Active all_;
};

}  // namespace

void nvdb::write_nvdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options) {
  vdb::check_indices(field, "nvdb");
  NvdbWriter(file, field, options.threads).write();
}

}  // namespace standoff
