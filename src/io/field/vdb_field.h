// SPDX-License-Identifier: Apache-2.0
// What the readers of OpenVDB's and NanoVDB's files share: what Blosc packed, a cursor, and the field that the nodes of
// a tree make.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "files/file_view.h"
#include "io/field/format.h"
#include "io/field/vdb_tree.h"

namespace standoff::vdb {

/// One byte packed by LZ4 unpacks to at most this many: a length of n bytes stands for about 255 n.
inline constexpr std::uint64_t kMostBlosc = 255;

/// Fills `to`, which must be all that was packed. Errors: input, also for other codecs.
void unpack_blosc(const FileView& file, const std::string& where, std::string_view packed, std::span<char> to);

class Cursor {
 public:
  explicit Cursor(const FileView& file, std::uint64_t at = 0) : file_(file), at_(at) {}

  template <class Number>
  Number number() {
    const Number value = file_.number<Number>(at_);
    at_ += sizeof value;
    return value;
  }
  std::string_view bytes(std::uint64_t count, const char* what) {
    file_.require(at_, count, what);
    const std::string_view part = file_.text(at_, count);
    at_ += count;
    return part;
  }
  /// After its length.
  std::string_view text(const char* what) { return bytes(number<std::uint32_t>(), what); }
  template <class Mask>
  void mask(Mask& mask) {
    const std::string_view part = bytes(sizeof mask.words, "a mask");
    std::memcpy(mask.words.data(), part.data(), part.size());
  }

  void go_to(std::uint64_t at) { at_ = at; }
  const FileView& file() const { return file_; }
  std::uint64_t at() const { return at_; }
  [[noreturn]] void fail(const std::string& what) const { file_.fail("byte " + std::to_string(at_), what); }

 private:
  const FileView& file_;
  std::uint64_t at_;
};

using Coordinates = std::array<std::int32_t, 3>;

/// What a file says beside its nodes.
struct Facts {
  std::optional<Size3> size;  ///< where standoff wrote it; otherwise that of all that is active
  Vec3 origin, spacing{1, 1, 1};
  std::optional<double> thickness;  ///< otherwise it is the background
  float background = 0;
  Provenance provenance;
};

class FieldBuilder {
 public:
  /// Errors: input, where the background is no thickness.
  FieldBuilder(const FileView& file, const Facts& facts, const FieldRequest& request);

  /// A leaf, or a tile of so many samples a side; the value of a tile is that of all its samples.
  struct Leaf {
    Coordinates at;
    Mask<kLeafLog> active;
  };
  struct Tile {
    Coordinates at;
    std::int64_t side;
    float value;
    bool active;
  };

  void find(const Leaf& leaf);
  void find(const Tile& tile);
  /// Call it when all nodes have been found.
  void end_finding();
  void count(const Leaf& leaf);
  void count(const Tile& tile);
  /// Call it when all nodes have been counted: it allocates the field. Errors: limit, before that.
  void begin_filling();
  /// No sample may be filled twice. `values` are in the order of a leaf.
  void fill(const Leaf& leaf, std::span<const float, 512> values);
  void fill(const Tile& tile);
  DistanceField take() { return std::move(field_); }

 private:
  struct Range {
    Size3 first, last;  ///< tiles of the field, the last one behind
    bool empty() const { return first.x >= last.x || first.y >= last.y || first.z >= last.z; }
  };
  void grow(const Coordinates& at, std::int64_t x, std::int64_t y, std::int64_t z);
  Range tiles_in(const Coordinates& at, std::int64_t side) const;
  float checked(float value, const Coordinates& at) const;
  bool is_clamped(float value) const { return std::abs(value) >= far_; }

  const FileView& file_;
  Facts facts_;
  FieldRequest request_;
  bool ours_;
  float far_;
  std::array<std::int64_t, 3> least_, most_, base_{};
  Grid grid_;
  double stored_ = 0;
  DistanceField field_;
};

}  // namespace standoff::vdb
