// SPDX-License-Identifier: Apache-2.0
// The caller's mesh as kernels read it: addresses, strides and types, by functions that are always inlined.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

#include "geometry/host_device.h"
#include "standoff/mesh_view.h"

namespace standoff::cpu {

struct MeshMemory {
  enum class Numbers : std::uint8_t {
    doubles,  ///< aligned doubles, read in place
    unaligned_doubles,
    floats,
  };

  const std::byte* vertices;
  std::ptrdiff_t vertex_stride;
  const std::byte* triangles;  ///< the low 32 bits of the first index: in a valid mesh, all others are 0
  std::ptrdiff_t triangle_stride;
  std::ptrdiff_t index_bytes;
  Numbers numbers;
  bool packed;  ///< aligned doubles and 32-bit indices without gaps: strides are constants
};

/// Requires a valid mesh.
inline MeshMemory memory_of(const MeshView& mesh) {
  using Numbers = MeshMemory::Numbers;
  const auto misaligned =
      reinterpret_cast<std::uintptr_t>(mesh.vertices.data()) | static_cast<std::uintptr_t>(mesh.vertices.stride());
  const bool floats = mesh.vertices.type() == VertexArray::Type::float32;
  const int index_bytes = mesh.triangles.index_bytes();
  const bool aligned = misaligned % alignof(double) == 0;
  return {mesh.vertices.data(),
          mesh.vertices.stride(),
          mesh.triangles.data() + (std::endian::native == std::endian::big ? index_bytes - 4 : 0),
          mesh.triangles.stride(),
          index_bytes,
          floats     ? Numbers::floats
          : !aligned ? Numbers::unaligned_doubles
                     : Numbers::doubles,
          aligned && mesh.vertices.packed() && mesh.triangles.packed()};
}

static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t),
              "packed vertices and triangles are read as arrays of these");

/// A corner's coordinates, in place or converted into `room`. kPacked requires mesh.packed.
template <bool kPacked>
STANDOFF_INLINE const double* corner_of(const MeshMemory& mesh, std::uint32_t triangle, int which, double* room) {
  std::uint32_t vertex;
  if (kPacked) {
    __builtin_memcpy(&vertex,
                     mesh.triangles + sizeof(Triangle) * triangle + sizeof vertex * static_cast<std::size_t>(which),
                     sizeof vertex);
    return reinterpret_cast<const double*>(mesh.vertices + sizeof(Vec3) * vertex);
  }
  __builtin_memcpy(&vertex, mesh.triangles + std::ptrdiff_t{triangle} * mesh.triangle_stride + which * mesh.index_bytes,
                   4);
  const std::byte* const at = mesh.vertices + std::ptrdiff_t{vertex} * mesh.vertex_stride;
  if (mesh.numbers == MeshMemory::Numbers::doubles) return reinterpret_cast<const double*>(at);
  if (mesh.numbers == MeshMemory::Numbers::floats) {
    float v[3];
    __builtin_memcpy(v, at, sizeof v);
    for (int k = 0; k < 3; ++k) room[k] = v[k];
  } else {
    __builtin_memcpy(room, at, 3 * sizeof(double));
  }
  return room;
}

/// Prefetches a triangle's indices for a later corner_of().
STANDOFF_INLINE void prefetch_indices(const MeshMemory& mesh, std::uint32_t triangle) {
  __builtin_prefetch(mesh.triangles + std::ptrdiff_t{triangle} * mesh.triangle_stride);
}

}  // namespace standoff::cpu
