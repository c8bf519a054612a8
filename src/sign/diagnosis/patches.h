// SPDX-License-Identifier: Apache-2.0
// Patches: triangles joined over edges of exactly two triangles, in one orientation each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/copies.h"
#include "sign/diagnosis/mesh_edges.h"

namespace standoff {

struct Patches {
  std::vector<std::uint32_t> of;           ///< for each triangle its patch; numbered by their first triangles
  std::vector<std::int8_t> turn;           ///< for each triangle 1, -1 reversed, 0 left out
  std::vector<std::uint8_t> unorientable;  ///< for each patch: whether it has but one side

  std::size_t size() const { return unorientable.size(); }
};

/// Within a patch neighbours are made consistent, and what is turned is the smaller part of it (of parts of equal size,
/// that without the first triangle). Where that is impossible (a Moebius strip), the patch is left as it is. Triangles
/// of Copies::either are free: they do not count there. A triangle that is left out, or has two equal corners, is a
/// patch of its own.
Patches find_patches(const MeshEdges& edges, const Copies& copies, std::size_t triangles);

/// Edges of exactly two triangles that are used which have the same direction in both.
std::int64_t inconsistent_edges(const MeshEdges& edges, std::span<const std::int8_t> use);

}  // namespace standoff
