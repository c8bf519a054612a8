// SPDX-License-Identifier: Apache-2.0
// Arrays as raw little-endian files, by which drivers pass meshes, points and answers to programs in other languages.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "standoff/mesh.h"

namespace standoff::bench {

template <class T>
void write_raw(const std::filesystem::path& path, const T* values, std::size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(T)));
  if (!file) throw std::runtime_error("cannot write " + path.string());
}

/// Writes vertices.f64 and triangles.u32 to `folder`, which it makes if necessary.
inline void save_mesh(const std::filesystem::path& folder, const Mesh& mesh) {
  std::filesystem::create_directories(folder);
  write_raw(folder / "vertices.f64", mesh.vertices.data(), mesh.vertices.size());
  write_raw(folder / "triangles.u32", mesh.triangles.data(), mesh.triangles.size());
}

}  // namespace standoff::bench
