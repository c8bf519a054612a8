// SPDX-License-Identifier: Apache-2.0
// Two quick passes that spare most meshes a diagnosis: whether a mesh is closed, and whether it faces outwards.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {

/// A mesh is closed if the edges of its triangles cancel. Vertices count by position, so a mesh need not be welded.
/// Edges of length 0 do not count. A sum of random numbers decides (closed.cpp): a closed mesh is always recognised,
/// and an open mesh is taken for a closed one with a probability of 2^-63, unless it was made for the purpose.
struct Closed {
  bool oriented = false;    ///< each edge is used as often in one direction as in the other: w is an integer everywhere
  bool unoriented = false;  ///< each edge is used an even number of times: the parity of crossings is well defined
};

/// The most bytes that is_closed() holds.
std::int64_t closed_bytes(MeshView mesh);

/// Requires a valid mesh. Runs on the threads of the calling TBB arena.
Closed is_closed(MeshView mesh);

/// The sums that decide. They are sums in groups: those of some triangles can be taken out again, exactly.
class EdgeSums {
 public:
  EdgeSums() = default;
  /// Of all triangles of a valid mesh. Runs on the threads of the calling TBB arena.
  explicit EdgeSums(MeshView mesh);
  /// Of some triangles, which must be valid.
  EdgeSums(MeshView mesh, std::span<const std::uint32_t> triangles);

  EdgeSums& operator+=(const EdgeSums& other);
  EdgeSums& operator-=(const EdgeSums& other);
  /// Whether the edges of these triangles cancel.
  Closed closed() const { return {area_ == 0, odd_[0] == 0 && odd_[1] == 0}; }

 private:
  std::uint64_t area_ = 0;
  std::array<std::uint64_t, 2> odd_{};
};

/// Whether no part of a closed mesh is inside out. True only if the normals of each set of triangles that share
/// vertices, by index, cancel, as in a closed set, and its volume is positive. Sets without area do not count, but some
/// set must have one. Does not depend on the number of threads. Requires a valid mesh. Runs on the threads of the
/// calling TBB arena.
bool faces_outwards(MeshView mesh);

/// What faces_outwards() decides by, for a mesh whose vertices move: sums of integers, which no order of moves rounds
/// differently. Where they are too near to what faces_outwards() rounds to be sure of its answer, they do not answer.
class OutwardSums {
 public:
  /// Requires a valid mesh. Runs on the threads of the calling TBB arena.
  explicit OutwardSums(MeshView mesh);
  /// The most that is held for so many triangles and vertices.
  static std::int64_t bytes(std::int64_t triangles, std::int64_t vertices);

  /// Takes over the corners of triangles, ascending, that moved. The indices are those of the constructor's mesh.
  void follow(MeshView before, MeshView after, std::span<const std::uint32_t> triangles);
  /// Whether faces_outwards() is true of the mesh as it is now, for sure.
  bool surely_outwards() const { return unsure_ == 0 && with_area_ > 0; }

 private:
  using Fixed = __int128;
  struct Terms {
    double volume, reach, normal_length;
    Vec3 normal;
  };
  // Of the triangles that share vertices. Integers are multiples of 2^unit.
  struct Set {
    Vec3 origin;          // volumes are relative to it
    std::uint32_t first;  // the lowest vertex
    std::uint32_t runs = 0, triangles = 0, triangles_with_area = 0;
    std::int16_t volume_unit = 0, normal_unit = 0;
    bool is_lost = false;  // a term was too large for its unit
    bool is_sure = false;
    Fixed volume = 0, reach = 0, normal[3]{}, normal_length = 0;
  };

  Terms terms_of(MeshView mesh, std::uint32_t triangle, const Set& set) const;
  void add(Set& set, const Terms& terms, int times);
  bool is_sure(const Set& set, MeshView mesh) const;
  void judge(Set& set, MeshView mesh);

  std::vector<std::uint32_t> set_of_;  // by vertex that a triangle uses
  std::vector<Set> sets_;
  std::int64_t unsure_ = 0, with_area_ = 0;  // sets
};

/// The most bytes that faces_outwards() holds. Takes about as long.
std::int64_t outward_bytes(MeshView mesh);

}  // namespace standoff
