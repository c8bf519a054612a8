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

void write_glb(AtomicFile& file, MeshView mesh);
void write_3mf(AtomicFile& file, MeshView mesh, const MeshWriteOptions& options);

/// Throws Error{output}, "FILE: what; what to do".
[[noreturn]] inline void fail_to_write(const AtomicFile& file, const std::string& message) {
  throw Error(ErrorCode::output, file.target().string() + ": " + message);
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
