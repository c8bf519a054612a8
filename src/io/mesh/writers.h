// SPDX-License-Identifier: Apache-2.0
// What the writers of mesh formats share, and those of formats whose readers are long.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "files/atomic_file.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/mesh.h"

namespace standoff {

void write_glb(AtomicFile& file, MeshView mesh, const MeshWriteOptions& options);
void write_3mf(AtomicFile& file, MeshView mesh, const MeshWriteOptions& options);

/// Throws Error{output}, "FILE: what; what to do".
[[noreturn]] inline void fail_to_write(const AtomicFile& file, const std::string& message) {
  throw Error(ErrorCode::output, file.target().string() + ": " + message);
}

/// A point of the mesh in a format in which `up` points up, and in its unit: metres if those are known.
inline Vec3 placed(Vec3 p, const MeshWriteOptions& options, Axis up) {
  if (options.metres_per_unit > 0) p = p * options.metres_per_unit;
  const Axis was = options.up.value_or(up);
  if (was == up) return p;
  Vec3 turned = p;
  turned[static_cast<std::size_t>(up)] = p[static_cast<std::size_t>(was)];
  turned[static_cast<std::size_t>(was)] = 0 - p[static_cast<std::size_t>(up)];
  return turned;
}

inline std::array<float, 3> as_floats(Vec3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

/// Of formats that hold nothing but floats. Rounding is what the caller asked for; infinity is not.
inline void check_fits_floats(const AtomicFile& file, Vec3 p, const std::string& format) {
  constexpr double largest = std::numeric_limits<float>::max();
  if (!(std::abs(p.x) <= largest && std::abs(p.y) <= largest && std::abs(p.z) <= largest))
    fail_to_write(file,
                  "a vertex is too far from the origin for the 32-bit floats of " + format + "; write .ply or .obj");
}

}  // namespace standoff
