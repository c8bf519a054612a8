// SPDX-License-Identifier: Apache-2.0
// VDB: files of OpenVDB, of versions 222 to 225 (since OpenVDB 3): a float grid whose axes are those of the world.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/number_text.h"
#include "files/file_view.h"
#include "files/zip.h"
#include "io/field/format.h"
#include "io/field/read_samples.h"
#include "io/field/vdb_field.h"
#include "io/field/vdb_format.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {
namespace {

class ValueReader {
 public:
  ValueReader(std::uint32_t compression, bool half, float background)
      : compression_(compression), half_(half), background_(background) {}

  /// The values of a node in its order, until the next call.
  template <int log>
  const float* read(Cursor& from, const Mask<log>& active) {
    return read(from, active.words.data(), Mask<log>::kBits);
  }

 private:
  const float* read(Cursor& from, const std::uint64_t* active, std::size_t count);
  void read_data(Cursor& from, std::size_t count);
  std::string_view unpacked(Cursor& from, std::size_t bytes);

  std::uint32_t compression_;
  bool half_;
  float background_;
  std::vector<float> stored_, values_;
  std::vector<char> unpacked_;
};

float from_half(std::uint16_t bits) {
  const int exponent = bits >> 10 & 31, mantissa = bits & 1023;
  const float sign = bits >> 15 ? -1.0f : 1.0f;
  if (exponent == 0) return sign * std::ldexp(static_cast<float>(mantissa), -24);
  if (exponent == 31) return mantissa ? std::nanf("") : sign * INFINITY;
  return sign * std::ldexp(static_cast<float>(1024 + mantissa), exponent - 25);
}

const float* ValueReader::read(Cursor& from, const std::uint64_t* active, std::size_t count) {
  const auto is_active = [&](std::size_t n) { return active[n / 64] >> n % 64 & 1; };
  const auto kind = from.number<ValuesKind>();
  if (kind > ValuesKind::all) from.fail("values of a node are stored in no known way; the file is damaged");
  // The mask, where there is one, selects the second.
  float first = kind == ValuesKind::background ? background_ : -background_, second = background_;
  if (kind == ValuesKind::one || kind == ValuesKind::background_or_one || kind == ValuesKind::two)
    first = from.number<float>();
  if (kind == ValuesKind::two) second = from.number<float>();
  const bool masked =
      kind == ValuesKind::background_or_negative || kind == ValuesKind::background_or_one || kind == ValuesKind::two;
  const std::string_view mask = masked ? from.bytes(count / 8, "a mask") : std::string_view();
  std::size_t stored = count;
  if ((compression_ & kActiveMask) && kind != ValuesKind::all) {
    stored = 0;
    for (std::size_t n = 0; n < count / 64; ++n) stored += static_cast<std::size_t>(std::popcount(active[n]));
  }
  read_data(from, stored);
  if (stored == count) return stored_.data();
  values_.resize(count);
  for (std::size_t n = 0, next = 0; n < count; ++n) {
    const bool selected = masked && (mask[n / 8] >> n % 8 & 1);
    values_[n] = is_active(n) ? stored_[next++] : selected ? second : first;
  }
  return values_.data();
}

void ValueReader::read_data(Cursor& from, std::size_t count) {
  stored_.resize(count);
  if (half_ && count == 0) return;
  const std::size_t bytes = count * (half_ ? 2 : 4);
  const std::string_view data =
      compression_ & (kZip | kBlosc) ? unpacked(from, bytes) : from.bytes(bytes, "the values of a node");
  for (std::size_t n = 0; n < count; ++n) {
    std::uint16_t half;
    if (half_) {
      std::memcpy(&half, data.data() + 2 * n, sizeof half);
      stored_[n] = from_half(half);
    } else {
      std::memcpy(&stored_[n], data.data() + 4 * n, sizeof stored_[n]);
    }
  }
}

// The length of the values comes first where values may be packed; it is negative if they are not.
std::string_view ValueReader::unpacked(Cursor& from, std::size_t bytes) {
  const std::uint64_t at = from.at();
  const auto length = from.number<std::int64_t>();
  const std::uint64_t packed =
      length < 0 ? ~static_cast<std::uint64_t>(length) + 1 : static_cast<std::uint64_t>(length);
  const std::string_view data = from.bytes(packed, "the packed values of a node");
  if (length <= 0) {
    if (packed != bytes) from.fail("a node has values for another number of samples; the file is damaged");
    return data;
  }
  unpacked_.resize(bytes);
  const std::string where = "byte " + std::to_string(at);
  if (compression_ & kBlosc)
    unpack_blosc(from.file(), where, data, unpacked_);
  else
    Inflater(from.file(), where, data, Inflater::Wrapper::zlib).fill(unpacked_.data(), bytes);
  return {unpacked_.data(), bytes};
}

struct GridDescriptor {
  std::string name, type;
  bool instance = false;
  std::uint64_t grid = 0, blocks = 0;

  bool half() const { return type.ends_with(kHalfSuffix); }
  bool is_float() const { return type == kFloatTree || type == std::string(kFloatTree) + std::string(kHalfSuffix); }
};

std::string name_of(const GridDescriptor& grid) {
  // OpenVDB adds a number to names that repeat, after a byte 30.
  return in_quotes(grid.name.substr(0, grid.name.find('\x1e'))) + " (" + shown(grid.type) + ")";
}

std::vector<GridDescriptor> read_descriptors(Cursor& from) {
  const FileView& file = from.file();
  if (file.size() < 8 || from.number<std::uint64_t>() != kMagic)
    file.fail("header", "it is no VDB file; check its name");
  constexpr std::uint32_t kNewest = 225;
  const auto version = from.number<std::uint32_t>();
  if (version < kOldest || version > kNewest)
    file.fail("header", "its version is " + std::to_string(version) + "; save it with OpenVDB 3 to 12");
  from.number<std::uint64_t>();  // of the library
  if (from.number<std::uint8_t>() == 0)
    file.fail("header", "it was written as a stream, without positions; write it to a file instead");
  from.bytes(kNoId.size(), "its identity");
  for (auto facts = from.number<std::uint32_t>(); facts > 0; --facts)
    for (const char* what : {"a fact's name", "a fact's type", "a fact"}) from.text(what);
  std::vector<GridDescriptor> grids;
  for (auto count = from.number<std::uint32_t>(); count > 0; --count) {
    GridDescriptor grid;
    grid.name = from.text("a grid's name");
    grid.type = from.text("a grid's type");
    grid.instance = !from.text("a grid's parent").empty();
    grid.grid = from.number<std::uint64_t>();
    grid.blocks = from.number<std::uint64_t>();
    const auto end = from.number<std::uint64_t>();
    grids.push_back(grid);
    if (grid.grid > file.size() || grid.blocks > file.size() || end < from.at() || end > file.size())
      file.fail(shown(grid.name), "the grid lies outside the file; it is cut off or damaged, get all of it");
    from.go_to(end);
  }
  return grids;
}

// Returns the grid of floats; of several, the one called distance.
GridDescriptor chosen(const FileView& file, const std::vector<GridDescriptor>& grids) {
  std::vector<GridDescriptor> floats;
  std::string names;
  for (const GridDescriptor& grid : grids) {
    if (grid.is_float()) floats.push_back(grid);
    if (names.size() < 300) names += (names.empty() ? "" : ", ") + name_of(grid);
  }
  if (floats.empty())
    file.fail(grids.empty() ? "it holds no grid; save a level set"
                            : "it holds no grid of floats, but " + names + "; save a level set of floats");
  if (floats.size() > 1) {
    std::erase_if(floats, [](const GridDescriptor& grid) { return grid.name != "distance"; });
    if (floats.size() != 1)
      file.fail("it holds several grids: " + names + "; save one, or call one of floats 'distance'");
  }
  if (floats[0].instance) file.fail(name_of(floats[0]), "it shares the tree of another grid; save it alone");
  return floats[0];
}

class VdbReader {
 public:
  VdbReader(const FileView& file, const FieldRequest& request)
      : file_(file), from_(file), grid_(chosen(file, read_descriptors(from_))), request_(request) {}

  DistanceField read() {
    from_.go_to(grid_.grid);
    compression_ = from_.number<std::uint32_t>();
    read_facts();
    read_transform();
    topology_ = from_.at();
    from_.number<std::uint32_t>();
    facts_.background = from_.number<float>();
    FieldBuilder builder(file_, facts_, request_);
    walk([&](const auto& node) { builder.find(node); });
    builder.end_finding();
    walk([&](const auto& node) { builder.count(node); });
    builder.begin_filling();
    std::vector<Coordinates> leaves;
    walk([&](const auto& node) {
      if constexpr (std::is_same_v<std::decay_t<decltype(node)>, FieldBuilder::Tile>)
        builder.fill(node);
      else
        leaves.push_back(node.at);
    });
    from_.go_to(grid_.blocks);
    ValueReader values(compression_, grid_.half(), facts_.background);
    std::size_t done = 0;
    for (const Coordinates& at : leaves) {
      if (++done % 256 == 0) from_.file().check();
      FieldBuilder::Leaf leaf{at, {}};
      from_.mask(leaf.active);
      builder.fill(leaf, std::span<const float, 512>(values.read(from_, leaf.active), 512));
    }
    return builder.take();
  }

 private:
  void read_facts() {
    for (auto count = from_.number<std::uint32_t>(); count > 0; --count) {
      const std::string_view name = from_.text("a fact's name"), type = from_.text("a fact's type"),
                             value = from_.text("a fact");
      const std::string text(value.substr(0, kMaxText));
      const auto is = [&](const char* fact, const char* of_type, std::size_t bytes) {
        return name == fact && type == of_type && value.size() == bytes;
      };
      if (is(kSizeFact, "vec3i", 12)) {
        Coordinates size;
        std::memcpy(size.data(), value.data(), sizeof size);
        facts_.size = {size[0], size[1], size[2]};
      }
      if (is(kThicknessFact, "double", 8)) {
        double thickness;
        std::memcpy(&thickness, value.data(), sizeof thickness);
        facts_.thickness = thickness;
      }
      if (type != "string") continue;
      if (name == kMethodFact) facts_.provenance.method = text;
      if (name == kVersionFact) facts_.provenance.version = text;
      if (name == kSignFact) facts_.provenance.sign = text;
      if (name == kUpFact) facts_.provenance.up = axis_in(text);
      if (name == kHashFact) facts_.provenance.mesh_hash = hash_in(text).value_or(0);
    }
  }

  Vec3 vector() {
    const auto x = from_.number<double>(), y = from_.number<double>(), z = from_.number<double>();
    return {x, y, z};
  }

  void read_transform() {
    const std::string type(from_.text("the type of the transform"));
    const bool translated = type.ends_with("TranslateMap");
    if (type == "ScaleMap" || type == "UniformScaleMap" || type == "ScaleTranslateMap" ||
        type == "UniformScaleTranslateMap") {
      if (translated) facts_.origin = vector();
      facts_.spacing = vector();
      for (int derived = 0; derived < 4; ++derived) vector();
    } else if (type == "TranslationMap") {
      facts_.origin = vector();
    } else if (type == "AffineMap") {
      double matrix[4][4];  // of rows of vectors, so the last one translates
      for (auto& row : matrix)
        for (double& number : row) number = from_.number<double>();
      for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column)
          if (row != column && matrix[row][column] != 0) fail_rotated();
      facts_.spacing = {matrix[0][0], matrix[1][1], matrix[2][2]};
      facts_.origin = {matrix[3][0], matrix[3][1], matrix[3][2]};
    } else {
      file_.fail(name_of(grid_), "its transform is a " + shown(type) + ", and not a scale per axis; resample it");
    }
  }
  [[noreturn]] void fail_rotated() const {
    file_.fail(name_of(grid_), "the axes of the grid must be those of the world; resample it");
  }

  Coordinates coordinates() {
    const Coordinates at = from_.number<Coordinates>();
    for (const std::int32_t c : at)
      if (c % kUpperSide != 0) from_.fail("a node that does not lie where nodes do; the file is damaged");
    if (!seen_.insert(at).second) from_.fail("two nodes at one place; the file is damaged");
    return at;
  }

  // Goes through the topology: use(Leaf) and use(Tile) for all that is not the background.
  template <class Use>
  void walk(const Use& use) {
    from_.go_to(topology_);
    seen_.clear();
    if (from_.number<std::uint32_t>() != 1) from_.fail("leaves with several buffers; save the grid again");
    from_.number<float>();  // the background
    const auto tiles = from_.number<std::uint32_t>(), children = from_.number<std::uint32_t>();
    for (std::uint32_t n = 0; n < tiles; ++n) {
      const Coordinates at = coordinates();
      const auto value = from_.number<float>();
      use(FieldBuilder::Tile{at, kUpperSide, value, from_.number<std::uint8_t>() != 0});
    }
    ValueReader upper(compression_, grid_.half(), facts_.background), lower = upper;
    for (std::uint32_t n = 0; n < children; ++n)
      node<kUpperLog>(coordinates(), kLowerSide, upper, use, [&](const Coordinates& at) {
        node<kLowerLog>(at, kLeafSide, lower, use, [&](const Coordinates& leaf_at) {
          FieldBuilder::Leaf leaf{leaf_at, {}};
          from_.mask(leaf.active);
          use(leaf);
        });
      });
  }

  template <int log, class Use, class Child>
  void node(const Coordinates& at, int side, ValueReader& reader, const Use& use, const Child& child) {
    Mask<log> children, active;
    from_.mask(children);
    from_.mask(active);
    const float* const values = reader.read(from_, active);
    const auto place = [&](std::size_t n) {
      const Size3 in_node = child_place<log>(n);
      // Less than 2^31: nodes of the root lie on multiples of their side.
      return Coordinates{static_cast<std::int32_t>(at[0] + side * in_node.x),
                         static_cast<std::int32_t>(at[1] + side * in_node.y),
                         static_cast<std::int32_t>(at[2] + side * in_node.z)};
    };
    for (std::size_t n = 0; n < Mask<log>::kBits; ++n)
      if (!children[n] && (active[n] || !(values[n] == facts_.background)))
        use(FieldBuilder::Tile{place(n), side, values[n], active[n]});
    for (std::size_t n = 0; n < Mask<log>::kBits; ++n)
      if (children[n]) child(place(n));
  }

  const FileView& file_;
  Cursor from_;
  GridDescriptor grid_;
  FieldRequest request_;
  std::uint32_t compression_ = 0;
  std::uint64_t topology_ = 0;
  Facts facts_;
  std::set<Coordinates> seen_;
};

FieldFile read_vdb(const FileView& file, const FieldRequest& request) { return {VdbReader(file, request).read(), {}}; }

}  // namespace
}  // namespace standoff::vdb

namespace standoff {

constinit const FieldFormat kFieldVdb{.extension = "vdb",
                                      .description = "OpenVDB, for Blender, Houdini and OpenVDB",
                                      .sparse = true,
                                      .read = vdb::read_vdb,
                                      .write = of_whole<vdb::write_vdb>};

}  // namespace standoff
