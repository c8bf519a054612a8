// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

#include "io/mesh/format.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little);

// True where a float holds c: its last 29 bits are zero, and its size is that of a normal float. Asked of the bits, as
// GCC 12 may drop the rounding from (double)(float)c when it packs several of them into one register.
bool is_float(double c) {
  const double size = std::abs(c);
  const bool in_range = size >= std::numeric_limits<float>::min() && size <= std::numeric_limits<float>::max();
  return c == 0 || (in_range && (std::bit_cast<std::uint64_t>(c) & ((1u << 29) - 1)) == 0);
}

bool all_floats(MeshView mesh) {
  return std::all_of(mesh.vertices.begin(), mesh.vertices.end(),
                     [](const Vec3& v) { return is_float(v.x) && is_float(v.y) && is_float(v.z); });
}

template <class Number>
void write_vertices(AtomicFile& file, MeshView mesh) {
  for (const Vec3& v : mesh.vertices) {
    const std::array<Number, 3> stored{static_cast<Number>(v.x), static_cast<Number>(v.y), static_cast<Number>(v.z)};
    file.write(stored.data(), sizeof stored);
  }
}

}  // namespace

// Floats where they lose nothing, which halves the file; doubles otherwise.
void write_ply(AtomicFile& file, MeshView mesh) {
  const bool floats = all_floats(mesh);
  const std::string type = floats ? "float" : "double";
  const std::string header = "ply\nformat binary_little_endian 1.0\ncomment written by standoff\nelement vertex " +
                             std::to_string(mesh.vertices.size()) + "\nproperty " + type + " x\nproperty " + type +
                             " y\nproperty " + type + " z\nelement face " + std::to_string(mesh.triangles.size()) +
                             "\nproperty list uchar uint vertex_indices\nend_header\n";
  file.write(header.data(), header.size());
  if (floats)
    write_vertices<float>(file, mesh);
  else
    write_vertices<double>(file, mesh);
  for (const Triangle& t : mesh.triangles) {
    std::array<char, 1 + sizeof t> record{3};
    std::memcpy(record.data() + 1, t.data(), sizeof t);
    file.write(record.data(), record.size());
  }
}

}  // namespace standoff
