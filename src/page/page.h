// SPDX-License-Identifier: Apache-2.0
// What a page is made of: JSON, bytes that pack well, meshes and fields as blobs of them, and the HTML around all.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "standoff/mesh_view.h"
#include "standoff/page.h"
#include "standoff/vec.h"

namespace standoff::page {

/// The text between quotes. No '<', '>', '&', U+2028 or U+2029 stands in it, so that it can end no script it stands in;
/// bytes that are no UTF-8 become U+FFFD.
std::string json_string(std::string_view text);
/// The number that reads back as the same; null for infinite ones and those that are none.
std::string json_number(double value);
std::string json_number(std::int64_t value);
inline std::string json_bool(bool value) { return value ? "true" : "false"; }
std::string json_triple(Vec3 value);
std::string json_triple(Size3 value);

/// An object, member by member.
class JsonObject {
 public:
  /// `value` is JSON already.
  JsonObject& add(std::string_view name, const std::string& value) {
    if (!text_.empty()) text_ += ',';
    text_.append(json_string(name)).append(":").append(value);
    return *this;
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

/// Appends the bytes, four characters for three of them, with '=' at the end where the count asks for it.
void append_base64(std::string& out, std::string_view bytes);

/// 0, -1, 1, -2 .. as 0, 1, 2, 3 ..: what is small in magnitude has few bits.
constexpr std::uint32_t zigzag(std::int32_t n) {
  return (static_cast<std::uint32_t>(n) << 1) ^ static_cast<std::uint32_t>(n >> 31);
}

/// The lowest byte of every number, then the second byte of every number, and so on: bytes of one kind pack better.
inline void put_planes(std::string& out, std::span<const std::uint32_t> numbers, int bytes) {
  out.reserve(out.size() + numbers.size() * static_cast<std::size_t>(bytes));
  for (int byte = 0; byte < bytes; ++byte)
    for (const std::uint32_t n : numbers) out += static_cast<char>(n >> (8 * byte));
}

/// Seven bits in a byte, the lowest first; all bytes but the last have their highest bit set.
inline void put_varint(std::string& out, std::uint32_t n) {
  for (; n >= 0x80; n >>= 7) out += static_cast<char>(n | 0x80);
  out += static_cast<char>(n);
}

/// A named part of a blob.
struct Section {
  std::string_view name;
  std::string bytes;
};

/// "SOPG", the header's length in 4 bytes (little endian), the header (JSON: `header` with a list of the sections'
/// names and lengths), and the sections one after the other; all of it as one zlib stream, or as it is with a
/// compression of 0.
std::string packed_blob(JsonObject header, const std::vector<Section>& sections, int compression);

/// A mesh whose corners lie on a cubic lattice. Vertices are in the order in which triangles name them first; those
/// that no triangle names are left out. Triangles are in the mesh's order, so that a field's nearest triangles are
/// theirs, unless there were too many.
struct LatticeMesh {
  Vec3 origin;      ///< world units, the box's least corner
  double step = 1;  ///< world units
  int bits = 16;    ///< of a coordinate: 16, or 24 where the mesh's triangles are small
  std::vector<std::array<std::uint32_t, 3>> vertices;  ///< in steps from the origin
  std::vector<Triangle> triangles;
  std::vector<Triangle> proxy;  ///< fewer triangles over the same vertices, or none
  bool simplified = false;      ///< there were more than options.most_triangles
};

/// Distances to a simplified surface, in parts of the mesh's size: a few pixels of a picture; or any, where things are
/// small on it.
inline constexpr float kSameShape = 0.004F, kAnyShape = 1e10F;

/// There is a proxy where few enough triangles are no farther than `proxy_error` from the surface. Of other meshes,
/// those of beams and wires, pages make one themselves (view/page/stand_in.js).
LatticeMesh lattice_mesh(MeshView mesh, const PageOptions& options, float proxy_error = kSameShape);
/// Fills `held`, unless null.
std::string mesh_blob(const PageMesh& mesh, const PageOptions& options, PageItem* held, float proxy_error = kSameShape);

/// Whether this build has meshoptimizer, which simplifies meshes.
bool can_simplify();

/// At most `most` triangles over the same vertices that look like the given ones; `most` is less than there are. The
/// vertices are any three floats each. Empty where this build cannot simplify, or not without a larger error, in parts
/// of their box's longest side.
std::vector<Triangle> simplified(std::span<const Triangle> triangles, std::span<const float> vertices, std::size_t most,
                                 float error = kAnyShape);

/// Whole numbers that stand for a field's values. What is finite lies within kMostCode.
inline constexpr std::int32_t kMostCode = 32766;
inline constexpr std::int32_t kInfiniteCode = 32767;  ///< and its negative
inline constexpr std::int32_t kNoNumberCode = -32768;

/// A field of which every `every`-th sample per axis is left, and its values in steps.
struct CodedField {
  Grid grid;
  std::int64_t every = 1;
  double step = 1;                                       ///< world units; a code times this is the value
  std::int32_t clamped = 0;                              ///< the code of the thickness; 0 where no value is clamped
  double min = std::numeric_limits<double>::infinity();  ///< of all values of the field, world units
  double max = -std::numeric_limits<double>::infinity();
  std::string tiles;                   ///< a byte for each tile of the grid, x fastest: 0 outside, 1 inside, 2 stored
  std::int64_t stored = 0;             ///< how many are stored
  std::vector<std::int32_t> codes;     ///< 512 of each stored tile, x fastest; beyond the grid anything
  std::vector<std::uint32_t> nearest;  ///< the same for nearest triangles; empty: none
};

CodedField coded_field(const DistanceField& field, const PageOptions& options);
/// Fills `held`, unless null.
std::string field_blob(const PageField& field, const PageOptions& options, PageItem* held);

/// The page with `blobs`, each as packed_blob() made it.
std::string html(std::string_view title, const PageOptions& options, const std::vector<std::string>& blobs);

}  // namespace standoff::page
