// SPDX-License-Identifier: Apache-2.0
// A mesh, a grid and our field in a file, for peers that do the same job (peer_jobs.py reads it).
#pragma once

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "standoff/error.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// Little-endian: int64 counts of vertices and triangles and the grid's size; doubles: origin, spacing, thickness,
/// vertices; uint32 triangles; float values.
inline void write_peer_file(const std::string& path, const Mesh& mesh, const Grid& grid, double thickness,
                            const std::vector<float>& values) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), std::fclose);
  bool good = file != nullptr;
  const auto put = [&](const void* data, std::size_t bytes) {
    good = good && std::fwrite(data, 1, bytes, file.get()) == bytes;
  };
  const std::int64_t counts[] = {static_cast<std::int64_t>(mesh.vertices.size()),
                                 static_cast<std::int64_t>(mesh.triangles.size()), grid.size.x, grid.size.y,
                                 grid.size.z};
  put(counts, sizeof counts);
  put(&grid.origin, sizeof grid.origin);
  put(&grid.spacing, sizeof grid.spacing);
  put(&thickness, sizeof thickness);
  put(mesh.vertices.data(), mesh.vertices.size() * sizeof mesh.vertices[0]);
  put(mesh.triangles.data(), mesh.triangles.size() * sizeof mesh.triangles[0]);
  put(values.data(), values.size() * sizeof values[0]);
  if (!good) throw Error(ErrorCode::input, "measure: cannot write " + path + "; is the disk full?");
}

}  // namespace standoff
