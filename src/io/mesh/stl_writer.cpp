// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string>

#include "io/mesh/format.h"
#include "io/mesh/stl_binary.h"
#include "standoff/error.h"

namespace standoff {
namespace {

[[noreturn]] void fail(const AtomicFile& file, const std::string& message) {
  throw Error(ErrorCode::output, file.target().string() + ": " + message);
}

std::array<float, 3> as_floats(Vec3 p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

// STL holds nothing but floats. Rounding is what the caller asked for; infinity is not.
bool fits_floats(Vec3 p) {
  constexpr double largest = std::numeric_limits<float>::max();
  return std::abs(p.x) <= largest && std::abs(p.y) <= largest && std::abs(p.z) <= largest;
}

Vec3 unit_normal(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const double size = length(n);
  return std::isnormal(size) ? n * (1 / size) : Vec3{};
}

}  // namespace

void write_stl(AtomicFile& file, MeshView mesh) {
  if (mesh.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    fail(file, "STL holds at most 4294967295 triangles; write .ply");
  std::array<char, kStlHeader> header{};
  constexpr std::string_view kText = "standoff, binary STL, little endian";
  kText.copy(header.data(), kText.size());
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size());
  std::memcpy(header.data() + kStlCount, &count, sizeof count);
  file.write(header.data(), header.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    if (!fits_floats(a) || !fits_floats(b) || !fits_floats(c))
      fail(file, "a vertex is too far from the origin for the 32-bit floats of STL; write .ply or .obj");
    std::array<char, kStlRecord> record{};
    char* at = record.data();
    for (const auto& floats : {as_floats(unit_normal(a, b, c)), as_floats(a), as_floats(b), as_floats(c)}) {
      std::memcpy(at, floats.data(), sizeof floats);
      at += sizeof floats;
    }
    file.write(record.data(), record.size());
  }
}

}  // namespace standoff
