// SPDX-License-Identifier: Apache-2.0
// The inner loop of sidecars, compiled once per instruction set (kernels_*.cpp) and chosen at run time. All sets give
// the same bits.
#pragma once

#include <cstdint>

#include "field/cpu/mesh_memory.h"
#include "standoff/execution.h"

namespace standoff::cpu {

/// A tile of a field and its sidecars. Samples without a nearest triangle stay unchanged.
struct SidecarTile {
  static constexpr int kSide = 8, kSamples = 512;

  const float* values;
  const std::uint32_t* nearest;         ///< triangles of the mesh, or kNoTriangle
  double x[kSide], y[kSide], z[kSide];  ///< coordinates of the samples, world units
  // Outputs, or null. All but features have three numbers per sample.
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
  /// Whether the gradient of negative values is opposite to the gradient of the distance.
  bool has_negative;
  /// Whether the gradient on the surface is the normal in the orientation of the sign; else it is the normal on the
  /// sample's side.
  bool has_sign;
  /// The orientation of each triangle (OrientedMesh::use), or null; and whether all are reversed.
  const std::int8_t* use;
  bool is_reversed;
};

struct SidecarKernels {
  static constexpr int kNoSuchTriangle = -1, kTooFar = -2;

  /// Fills the outputs. Returns the number of samples on the surface by slope_of(), or kNoSuchTriangle if the mesh
  /// lacks a nearest triangle, or kTooFar if one is larger or farther than 2^100 scaled units.
  int (*fill)(const SidecarMesh&, const SidecarTile&);

  static const SidecarKernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

}  // namespace standoff::cpu
