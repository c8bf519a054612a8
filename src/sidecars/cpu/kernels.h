// SPDX-License-Identifier: Apache-2.0
// The inner loop of sidecars, compiled once per instruction set (kernels_*.cpp) and chosen at run time. All sets give
// the same bits.
#pragma once

#include <cstdint>

#include "field/cpu/mesh_memory.h"
#include "standoff/execution.h"

namespace standoff::cpu {

/// A tile of a field and what is beside it. Samples without a nearest triangle are left as they are.
struct SidecarTile {
  static constexpr int kSide = 8, kSamples = 512;

  const float* values;
  const std::uint32_t* nearest;         ///< triangles of the mesh, or kNoTriangle
  double x[kSide], y[kSide], z[kSide];  ///< coordinates of its samples, world units
  // Outputs, or null. All but features have three numbers for each sample.
  float* closest_point;
  float* barycentric;
  std::uint8_t* feature;
  float* gradient;
};

struct SidecarMesh {
  MeshMemory memory;
  std::uint32_t triangles;
  /// A power of two that makes lengths moderate, and its inverse.
  double scale, unscale;
  /// The gradient of negative values is against that of the distance.
  bool has_negative;
  /// On the surface it is the normal in the orientation of the sign, and not on the sample's side.
  bool has_sign;
  /// The orientation of each triangle (OrientedMesh::use), or null; and
  /// whether all are turned.
  const std::int8_t* use;
  bool turned;
};

struct SidecarKernels {
  static constexpr int kNoSuchTriangle = -1, kTooFar = -2;

  /// Fills the outputs. Returns how many samples are on the surface, as slope_of() says; kNoSuchTriangle where
  /// a nearest triangle is none of the mesh's; kTooFar where one is larger or farther than 2^100 scaled units.
  int (*fill)(const SidecarMesh&, const SidecarTile&);
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const SidecarKernels& sidecar_kernels_for(Simd simd);

}  // namespace standoff::cpu
