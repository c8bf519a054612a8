// SPDX-License-Identifier: Apache-2.0
// NVDB: NanoVDB's files, of its ABI 32: a grid of floats whose axes are those of the world. Nothing in the file is
// trusted: nodes have their place from the path that leads to them, and every offset is checked.
#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "core/memory.h"
#include "core/number_text.h"
#include "files/file_view.h"
#include "files/text.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/nvdb_format.h"
#include "io/field/read_samples.h"
#include "io/field/vdb_field.h"
#include "standoff/error.h"

namespace standoff {
namespace {

using namespace vdb;

// A grid in memory or in the file, unpacked.
struct FoundTile {
  std::unique_ptr<FileView> unpacked;
  std::uint64_t at = 0, bytes = 0;  // in what was unpacked, or in the file
};

std::unique_ptr<FileView> unpack(const FileView& file, std::uint64_t at, std::uint64_t packed, std::uint64_t bytes,
                                 nvdb::Codec codec, std::int64_t memory_limit) {
  const std::uint64_t most = codec == nvdb::Codec::blosc ? kMostBlosc : kMostDeflated;
  if (bytes / most > packed) file.fail("grid", "it is too short for what it says; get all of the file");
  if (memory_limit > 0 && bytes > static_cast<std::uint64_t>(memory_limit)) {
    ErrorDetails details = limit_details(static_cast<double>(bytes), static_cast<double>(memory_limit));
    details.file = file.path().string();
    throw Error(ErrorCode::limit,
                details.file + ": its grid needs " +
                    over_the_limit(static_cast<double>(bytes), static_cast<double>(memory_limit)) +
                    "; give a higher limit",
                details);
  }
  auto unpacked = std::make_unique_for_overwrite<char[]>(bytes);
  constexpr std::uint64_t kChunk = std::uint64_t{1} << 30;
  Cursor from(file, at);
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t part = codec == nvdb::Codec::blosc ? std::min(bytes - done, kChunk) : bytes;
    const std::string where = "byte " + std::to_string(from.at());
    const auto length = from.number<std::uint64_t>();
    const std::string_view data = from.bytes(length, "the packed grid");
    if (codec == nvdb::Codec::blosc)
      unpack_blosc(file, where, data, {unpacked.get() + done, part});
    else
      Inflater(file, where, data, Inflater::Wrapper::zlib).fill(unpacked.get(), part);
    done += part;
  }
  return std::make_unique<FileView>(file, std::move(unpacked), bytes);
}

// Finds the grid of floats; of several, the one called distance.
FoundTile find_grid(const FileView& file, std::int64_t memory_limit) {
  namespace f = nvdb::file;
  const auto magic = file.size() < 8 ? 0 : file.number<std::uint64_t>(0);
  if (magic == nvdb::kMagicGrid) return {nullptr, 0, file.size()};
  if (magic != nvdb::kMagic && magic != nvdb::kMagicFile) file.fail("header", "it is no NanoVDB file; check its name");
  const auto version = file.number<std::uint32_t>(8);
  if (version >> 21 != nvdb::kMajor)
    file.fail("header", "it has version " + std::to_string(version >> 21) + "; save it with NanoVDB 32");
  const auto count = file.number<std::uint16_t>(f::kGridCount);
  const auto codec = file.number<nvdb::Codec>(f::kCodec);
  if (codec > nvdb::Codec::blosc) file.fail("header", "it is packed in an unknown way; save it plain");
  struct Candidate {
    std::string name;
    std::uint64_t at, packed, bytes;
  };
  std::vector<Candidate> floats;
  std::string names;
  std::uint64_t meta = f::kHeaderBytes, data = 0;
  for (int pass = 0; pass < 2; ++pass) {  // how long the descriptions are, then where grids are
    std::uint64_t at = meta, grid = data;
    for (unsigned n = 0; n < count; ++n) {
      const std::uint64_t bytes = file.number<std::uint64_t>(at + f::kGridSize),
                          packed = file.number<std::uint64_t>(at + f::kFileSize);
      const auto type = file.number<std::uint32_t>(at + f::kType),
                 name_bytes = file.number<std::uint32_t>(at + f::kNameSize);
      file.require(at + f::kMetaBytes, name_bytes, "a grid's name");
      const std::string name = std::string(file.text(at + f::kMetaBytes, name_bytes)).c_str();
      at += f::kMetaBytes + name_bytes;
      if (pass == 0) continue;
      file.require(grid, packed, "a grid");
      if (names.size() < 300) names += (names.empty() ? "" : ", ") + in_quotes(name);
      if (type == nvdb::kFloat) floats.push_back({name, grid, packed, bytes});
      grid += packed;
    }
    data = at;
  }
  if (floats.empty()) file.fail("it holds no grid of floats" + (names.empty() ? "" : ", but " + names) + "; save one");
  if (floats.size() > 1) {
    std::erase_if(floats, [](const Candidate& grid) { return grid.name != "distance"; });
    if (floats.size() != 1)
      file.fail("it holds several grids: " + names + "; save one, or call one of floats 'distance'");
  }
  const Candidate& one = floats[0];
  if (codec == nvdb::Codec::none) return {nullptr, one.at, one.packed};
  return {unpack(file, one.at, one.packed, one.bytes, codec, memory_limit), 0, one.bytes};
}

class NvdbReader {
 public:
  NvdbReader(const FileView& file, std::uint64_t at, std::uint64_t bytes, const FieldRequest& request)
      : file_(file), at_(at), bytes_(bytes), request_(request) {}

  DistanceField read() {
    read_grid();
    FieldBuilder builder(file_, facts_, request_);
    walk([&](const auto& node, std::uint64_t) { builder.find(node); });
    builder.end_finding();
    walk([&](const auto& node, std::uint64_t) { builder.count(node); });
    builder.begin_filling();
    std::array<float, 512> values;
    walk([&](const auto& node, std::uint64_t place) {
      if constexpr (std::is_same_v<std::decay_t<decltype(node)>, FieldBuilder::Tile>) {
        builder.fill(node);
      } else {
        read_into(place + nvdb::leaf::kValues, values);
        builder.fill(node, values);
      }
    });
    return builder.take();
  }

 private:
  // `at` counts from the beginning of the grid.
  void require(std::uint64_t at, std::uint64_t bytes) const {
    if (at > bytes_ || bytes > bytes_ - at)
      file_.fail("grid", "a part of it lies outside; the file is cut off or damaged, get all of it");
  }
  template <class Value>
  void read_into(std::uint64_t at, Value& value) const {
    require(at, sizeof value);
    const std::string_view part = file_.text(at_ + at, sizeof value);
    if (part.size() != sizeof value) file_.fail("grid", "it is cut off; get all of the file");
    std::memcpy(&value, part.data(), sizeof value);
  }
  template <class Number>
  Number number(std::uint64_t at) const {
    Number value;
    read_into(at, value);
    return value;
  }

  void read_grid() {
    namespace g = nvdb::grid;
    const auto magic = number<std::uint64_t>(0);
    if (magic != nvdb::kMagic && magic != nvdb::kMagicGrid)
      file_.fail("grid", "it does not begin as grids do; the file is damaged");
    if (number<std::uint32_t>(g::kVersionAt) >> 21 != nvdb::kMajor || number<std::uint32_t>(g::kType) != nvdb::kFloat)
      file_.fail("grid", "it is no grid of floats of NanoVDB 32; save one");
    const auto matrix = number<std::array<double, 9>>(g::kMatrix);
    for (std::size_t n = 0; n < 9; ++n)
      if (n % 4 != 0 && matrix[n] != 0) file_.fail("grid", "its axes must be those of the world; resample it");
    const auto vector = number<std::array<double, 3>>(g::kVector);
    facts_.spacing = {matrix[0], matrix[4], matrix[8]};
    facts_.origin = {vector[0], vector[1], vector[2]};
    const std::uint64_t tree = g::kBytes;
    root_ = inside(tree, number<std::uint64_t>(tree + nvdb::tree::kNodeOffset + 24), nvdb::root::kBytes);
    facts_.background = number<float>(root_ + nvdb::root::kBackground);
    read_blind();
  }

  // A structure that lies `offset` bytes from another one, which may be before it.
  std::uint64_t inside(std::uint64_t from, std::uint64_t offset, std::uint64_t bytes) const {
    const std::uint64_t at = from + offset;  // modulo 2^64, as negative ones are meant
    require(at, bytes);
    return at;
  }

  void read_blind() {
    namespace b = nvdb::blind;
    const std::uint64_t first = number<std::uint64_t>(nvdb::grid::kBlindOffset);
    const auto count = number<std::uint32_t>(nvdb::grid::kBlindCount);
    for (std::uint64_t n = 0; n < count; ++n) {
      const std::uint64_t at = inside(first, n * b::kBytes, b::kBytes);
      const auto name = number<std::array<char, 256>>(at + b::kName);
      if (std::string_view(name.data(), 9) != std::string_view("standoff\0", 9)) continue;
      const auto elements = number<std::uint64_t>(at + b::kElements);
      constexpr std::uint64_t kMostFacts = 8 * kMaxText / 4;
      if (elements > kMostFacts) return;
      const std::uint64_t data = inside(at, number<std::uint64_t>(at + b::kOffset), 4 * elements);
      return read_facts(file_.text(at_ + data, 4 * elements));
    }
  }

  void read_facts(std::string_view text) {
    text = text.substr(0, text.find('\0'));
    while (!text.empty()) {
      const std::string_view line = text.substr(0, text.find('\n'));
      text.remove_prefix(std::min(text.size(), line.size() + 1));
      const auto equals = line.find('=');
      if (equals == std::string_view::npos) continue;
      const std::string_view name = line.substr(0, equals);
      const std::string value = unescaped(line.substr(equals + 1)).substr(0, kMaxText);
      if (name == "thickness") facts_.thickness = number_in<double>(value);
      if (name == "method") facts_.provenance.method = value;
      if (name == "version") facts_.provenance.version = value;
      if (name == "sign") facts_.provenance.sign = value;
      if (name == "up") facts_.provenance.up = axis_in(value);
      if (name == "mesh_hash") facts_.provenance.mesh_hash = hash_in(value).value_or(0);
      if (name != "size") continue;
      const auto words = words_of(value);
      std::array<std::int64_t, 3> size{};
      for (std::size_t axis = 0; axis < 3 && words.size() == 3; ++axis)
        size[axis] = number_in<std::int64_t>(words[axis]).value_or(0);
      facts_.size = {size[0], size[1], size[2]};
    }
  }
  // Goes through all nodes: use(Leaf, its place) and use(Tile, 0) for all that is not the background. A damaged file
  // may lead to one node by many paths: there are never more than fit into the file.
  template <class Use>
  void walk(const Use& use) {
    namespace r = nvdb::root;
    nodes_left_ = bytes_ / nvdb::leaf::kBytes;
    std::set<Coordinates> places;
    const std::uint64_t count = number<std::uint32_t>(root_ + r::kTableSize);
    require(root_ + r::kBytes, count * r::kTileBytes);
    for (std::uint64_t n = 0; n < count; ++n) {
      const std::uint64_t tile = root_ + r::kBytes + n * r::kTileBytes;
      const auto key = number<std::uint64_t>(tile);
      const auto axis = [&](int shift) {  // 20 bits, the upper one the sign
        const auto bits = static_cast<std::uint32_t>(key >> shift) << 12;
        return static_cast<std::int32_t>(bits);
      };
      const Coordinates at{axis(42), axis(21), axis(0)};
      if (!places.insert(at).second) file_.fail("root", "two nodes at one place; the file is damaged");
      const auto child = number<std::uint64_t>(tile + r::kChild);
      if (child == 0) {
        use(FieldBuilder::Tile{at, kUpperSide, number<float>(tile + r::kValue),
                               number<std::uint32_t>(tile + r::kState) != 0},
            0);
        continue;
      }
      inner<kUpperLog>(inside(root_, child, nvdb::Inner<kUpperLog>::kBytes), at, kLowerSide, use,
                       [&](std::uint64_t upper, std::uint64_t lower_offset, const Coordinates& lower_at) {
                         const std::uint64_t lower = inside(upper, lower_offset, nvdb::Inner<kLowerLog>::kBytes);
                         inner<kLowerLog>(lower, lower_at, kLeafSide, use,
                                          [&](std::uint64_t from, std::uint64_t offset, const Coordinates& leaf_at) {
                                            leaf(inside(from, offset, nvdb::leaf::kBytes), leaf_at, use);
                                          });
                       });
    }
  }

  void count_node(std::uint64_t bytes) {
    const std::uint64_t nodes = bytes / nvdb::leaf::kBytes;
    if (nodes > nodes_left_) file_.fail("grid", "it has more nodes than fit into the file; the file is damaged");
    nodes_left_ -= nodes;
  }

  template <int log, class Use, class Child>
  void inner(std::uint64_t place, const Coordinates& at, int side, const Use& use, const Child& child) {
    using N = nvdb::Inner<log>;
    count_node(N::kBytes);
    Mask<log> children, active;
    read_into(place + N::kChildMask, children.words);
    read_into(place + N::kValueMask, active.words);
    for (std::size_t n = 0; n < Mask<log>::kBits; ++n) {
      const Size3 in_node = child_place<log>(n);
      const Coordinates child_at{static_cast<std::int32_t>(at[0] + side * in_node.x),
                                 static_cast<std::int32_t>(at[1] + side * in_node.y),
                                 static_cast<std::int32_t>(at[2] + side * in_node.z)};
      if (children[n]) {
        child(place, number<std::uint64_t>(place + N::kTable + 8 * n), child_at);
        continue;
      }
      const auto value = number<float>(place + N::kTable + 8 * n);
      if (active[n] || !(value == facts_.background)) use(FieldBuilder::Tile{child_at, side, value, active[n]}, 0);
    }
  }

  template <class Use>
  void leaf(std::uint64_t place, const Coordinates& at, const Use& use) {
    count_node(nvdb::leaf::kBytes);
    if (nodes_left_ % 256 == 0) file_.check();
    FieldBuilder::Leaf found{at, {}};
    read_into(place + nvdb::leaf::kMask, found.active.words);
    use(found, place);
  }

  const FileView& file_;
  std::uint64_t at_, bytes_;
  FieldRequest request_;
  Facts facts_;
  std::uint64_t root_ = 0, nodes_left_ = 0;
};

FieldFile read_nvdb(const FileView& file, const FieldRequest& request) {
  const FoundTile found = find_grid(file, request.memory_limit);
  return {NvdbReader(found.unpacked ? *found.unpacked : file, found.at, found.bytes, request).read(), {}};
}

}  // namespace

constinit const FieldFormat kFieldNvdb{.extension = "nvdb",
                                       .description = "NanoVDB, for Warp and GPUs",
                                       .sparse = true,
                                       .read = read_nvdb,
                                       .write = of_whole<nvdb::write_nvdb>};

}  // namespace standoff
