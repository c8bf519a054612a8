// SPDX-License-Identifier: Apache-2.0
// The triangles of parts of space, found in logarithmic time: windows of a grid look at no others.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/bvh.h"
#include "sign/oriented_mesh.h"
#include "standoff/mesh.h"

namespace standoff {

class MeshParts {
 public:
  /// `among`: ascending indices into mesh.triangles; empty: all of them. The mesh must stay where it is. Runs on the
  /// threads of the calling TBB arena. Throws Error{interrupted}.
  MeshParts(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress);
  /// The memory of parts of a mesh of so many triangles, with all of them in one part.
  static std::int64_t bytes(std::int64_t triangles);

  /// Takes over the corners of triangles, ascending, that moved. Not for parts of `among`. Returns false where one went
  /// so far that new parts must take the place of these. The first call takes a pass over all triangles.
  bool follow(MeshView mesh, std::span<const std::uint32_t> moved);
  /// What follow() holds besides bytes().
  static std::int64_t following_bytes(std::int64_t triangles) {
    return triangles * static_cast<std::int64_t>(sizeof(std::uint32_t));
  }

  /// The triangles whose boxes touch this one, ascending; a few more may be among them. The box may be infinite.
  std::vector<std::uint32_t> touching(const Box& box) const;
  /// Those of them for which counts(triangle) is true.
  template <class Counts>
  std::vector<std::uint32_t> touching(const Box& box, const Counts& counts) const {
    std::vector<std::uint32_t> found;
    for_each_overlap(bvh_, local(box), [&](std::uint32_t place) {
      if (counts(bvh_.order()[place])) found.push_back(bvh_.order()[place]);
    });
    sort_ascending(found);
    return found;
  }
  /// Whether there are any.
  bool touch(const Box& box) const;

 private:
  FloatBox local(const Box& box) const;
  static void sort_ascending(std::vector<std::uint32_t>& triangles);

  Bvh bvh_;
  std::vector<std::uint32_t> place_of_;  // by triangle; for follow()
};

/// Some triangles of an oriented mesh as a mesh of their own, which shares its vertices.
class MeshPart {
 public:
  /// `among` may be empty: a part of nothing.
  MeshPart(const OrientedMesh& mesh, std::span<const std::uint32_t> among);

  OrientedMesh oriented() const { return {{vertices_, triangles_}, use_}; }

 private:
  VertexArray vertices_;
  std::vector<Triangle> triangles_;
  std::vector<std::int8_t> use_;
};

}  // namespace standoff
