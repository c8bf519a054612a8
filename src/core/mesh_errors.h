// SPDX-License-Identifier: Apache-2.0
// What is wrong with a triangle, in words and as data.
#pragma once

#include <string>

#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {

/// Throws Error{input} about one triangle.
[[noreturn]] inline void fail_triangle(std::size_t triangle, const std::string& what) {
  throw Error(ErrorCode::input, "mesh: triangle " + std::to_string(triangle) + ": " + what + "; repair the mesh",
              {.triangle = static_cast<std::int64_t>(triangle)});
}

/// Throws Error{input} about the k-th index of a triangle, which is out of range.
[[noreturn]] inline void fail_index(const MeshView& mesh, std::size_t triangle, int k) {
  fail_triangle(triangle, "index " + std::to_string(mesh.triangles.index(triangle, k)) +
                              " is out of range, there are " + std::to_string(mesh.vertices.size()) + " vertices");
}

}  // namespace standoff
