// SPDX-License-Identifier: Apache-2.0
// Writes GLB, binary glTF 2.0: a header, the JSON, and one buffer with the positions as floats, then the indices. There
// are no normals, so that viewers shade the triangles flat, as the specification asks for.
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "core/number_text.h"
#include "io/mesh/writers.h"

namespace standoff {
namespace {

using FloatPoint = std::array<float, 3>;

std::string json_numbers(const FloatPoint& point) {
  return "[" + exact_text(point[0]) + "," + exact_text(point[1]) + "," + exact_text(point[2]) + "]";
}

// One scene of one node of one mesh. The bounds of positions must be those of the floats, to the last bit.
std::string glb_json(MeshView mesh, const FloatPoint& least, const FloatPoint& most) {
  const std::string positions = std::to_string(12 * mesh.vertices.size());
  const std::string indices = std::to_string(12 * mesh.triangles.size());
  const std::string bytes = std::to_string(12 * (mesh.vertices.size() + mesh.triangles.size()));
  std::string json = R"({"asset":{"version":"2.0","generator":"standoff"},"scene":0,"scenes":[{"nodes":[0]}],)"
                     R"("nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
                     R"("accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
                     std::to_string(mesh.vertices.size()) + R"(,"min":)" + json_numbers(least) + R"(,"max":)" +
                     json_numbers(most) + R"(},{"bufferView":1,"componentType":5125,"type":"SCALAR","count":)" +
                     std::to_string(3 * mesh.triangles.size()) + R"(}],"bufferViews":[{"buffer":0,"byteLength":)" +
                     positions + R"(,"target":34962},{"buffer":0,"byteOffset":)" + positions + R"(,"byteLength":)" +
                     indices + R"(,"target":34963}],"buffers":[{"byteLength":)" + bytes + "}]}";
  json.resize((json.size() + 3) / 4 * 4, ' ');  // chunks begin at multiples of four bytes
  return json;
}

void write_numbers(AtomicFile& file, std::initializer_list<std::uint32_t> numbers) {
  file.write(numbers.begin(), numbers.size() * sizeof(std::uint32_t));
}

}  // namespace

void write_glb(AtomicFile& file, MeshView mesh, const MeshWriteOptions& options) {
  constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
  constexpr std::uint64_t kHeaders = 12 + 2 * 8, kMost = std::numeric_limits<std::uint32_t>::max();
  FloatPoint least, most;
  least.fill(std::numeric_limits<float>::max());
  most.fill(std::numeric_limits<float>::lowest());
  for (const Vec3& vertex : mesh.vertices) {
    const Vec3 p = placed(vertex, options, Axis::y);
    check_fits_floats(file, p, "GLB");
    const FloatPoint floats = as_floats(p);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      least[axis] = std::min(least[axis], floats[axis]);
      most[axis] = std::max(most[axis], floats[axis]);
    }
  }
  const std::string json = glb_json(mesh, least, most);
  const std::uint64_t binary = 12 * (std::uint64_t{mesh.vertices.size()} + mesh.triangles.size());
  const std::uint64_t total = kHeaders + json.size() + binary;
  if (total > kMost) fail_to_write(file, "GLB holds at most 4 GiB; write .ply");
  write_numbers(file, {kMagic, kVersion, static_cast<std::uint32_t>(total)});
  write_numbers(file, {static_cast<std::uint32_t>(json.size()), kJsonChunk});
  file.write(json.data(), json.size());
  write_numbers(file, {static_cast<std::uint32_t>(binary), kBinaryChunk});
  for (const Vec3& vertex : mesh.vertices) {
    const FloatPoint floats = as_floats(placed(vertex, options, Axis::y));
    file.write(floats.data(), sizeof floats);
  }
  for (const Triangle& t : mesh.triangles) file.write(t.data(), sizeof t);
}

}  // namespace standoff
