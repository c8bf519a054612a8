// SPDX-License-Identifier: Apache-2.0
// glTF 2.0, as JSON or binary: the triangles of its scene, where their nodes place them.
#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/text_cursor.h"
#include "io/mesh/builder.h"
#include "io/mesh/format.h"
#include "io/mesh/gltf_buffers.h"
#include "io/mesh/gltf_meshes.h"
#include "io/mesh/gltf_nodes.h"
#include "io/mesh/gltf_numbers.h"
#include "io/mesh/json_view.h"
#include "io/mesh/scene.h"

namespace standoff {
namespace {

// Ten times what scenes need; each level takes a frame of the reader's stack.
constexpr int kDeepestScene = 200;

void check_version(const FileView& file, const JsonView& root) {
  const auto asset = root.find("asset"), version = asset ? asset->find("version") : std::nullopt,
             least = asset ? asset->find("minVersion") : std::nullopt;
  if (!version) file.fail("", "its asset has no version; check that it is a glTF file, and write it again");
  const auto shown = [](const JsonView& json) {
    return json.kind() == JsonView::Kind::string ? json.text() : std::string("1");  // version 1 wrote numbers, too
  };
  if (!shown(*version).starts_with("2.") || (least && shown(*least) != "2.0"))
    version->fail("version " + in_quotes(shown(least ? *least : *version)) +
                  " of glTF is not read; convert it to version 2.0, or to STL, PLY or OBJ");
}

// Extensions that a file needs to be understood, and that change nothing of its shape or are read.
void check_extensions(const FileView& file, const JsonView& root) {
  constexpr std::array<std::string_view, 9> kHarmless{"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",
                                                      "KHR_lights_",           "KHR_technique",  "EXT_texture_",
                                                      "EXT_materials_",        "EXT_lights_",    "MSFT_texture_"};
  const auto required = root.find("extensionsRequired");
  if (!required) return;
  required->each_element([&](const JsonView& json) {
    const std::string name = json.text();
    if (std::ranges::none_of(kHarmless, [&](std::string_view known) { return name.starts_with(known); }))
      file.fail("", "it cannot be read without the extension " + in_quotes(name) +
                        ", which is not read here; write the file again without it, meshes uncompressed");
  });
}

Mesh read_scene(const FileView& file, std::string_view json, std::optional<std::string_view> binary) {
  const JsonView root = JsonView::read(file, json, kDeepestScene);
  check_version(file, root);
  check_extensions(file, root);
  GltfBuffers buffers(file, root.find("buffers"), root.find("bufferViews"), binary);
  GltfNumbers numbers(file, root.find("accessors"), buffers);
  GltfMeshes meshes(file, root.find("meshes"), numbers);
  const GltfNodes nodes(file, root);

  Unfolded unfolded;
  nodes.each_mesh([&](std::uint64_t mesh, const Placement&) {
    const Unfolded size = meshes.size(mesh);
    unfolded.vertices += size.vertices;
    unfolded.triangles += size.triangles;
    unfolded.corners = std::max(unfolded.corners, size.corners);
  });
  check_unfolded(file, unfolded, file.size() + buffers.companion_bytes());
  check_counts(file, static_cast<std::uint64_t>(unfolded.vertices), static_cast<std::uint64_t>(unfolded.triangles));

  MeshBuilder builder(file);
  builder.vertices.reserve(static_cast<std::size_t>(unfolded.vertices));
  builder.triangles.reserve(static_cast<std::size_t>(unfolded.triangles));
  nodes.each_mesh([&](std::uint64_t mesh, const Placement& placement) { meshes.place(mesh, placement, builder); });
  return builder.finish([&](std::size_t vertex) { return meshes.place_of_vertex(vertex); });
}

std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte); }

constexpr std::size_t kHeader = 12, kChunkHeader = 8;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

// The length in the header of a binary glTF.
std::size_t check_header(const FileView& file) {
  const std::string_view bytes = file.bytes();
  if (!bytes.starts_with("glTF")) file.fail(at_byte(0), "a binary glTF starts with glTF; check that it is one");
  if (bytes.size() < kHeader + kChunkHeader)
    file.fail(at_byte(bytes.size()), "the file ends in its header; it is cut off, get all of it");
  if (const auto version = number_at(bytes, 4); version != 2)
    file.fail(at_byte(4), "version " + std::to_string(version) + " of glTF is not read; convert it to version 2");
  const std::size_t length = number_at(bytes, 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader)
    file.fail(at_byte(8), "it promises " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()) +
                              "; it is cut off or damaged, get all of it");
  return length;
}

constexpr std::uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;

// Where the next chunk begins. Chunks are padded to a multiple of four bytes, and their lengths count that. Some
// programs do not pad; some do, and do not count it. Which one it was, the type of a binary chunk tells.
std::size_t next_chunk(std::string_view bytes, std::size_t end, std::size_t length) {
  const std::size_t padded = (end + 3) / 4 * 4;
  const bool unpadded = end != padded && length - end >= kChunkHeader && number_at(bytes, end + 4) == kBinary;
  return std::min(length, unpadded ? end : padded);
}

}  // namespace

Mesh read_gltf(const FileView& file) { return read_scene(file, file.bytes(), {}); }

// Chunks: the JSON first, then the binary part; others are passed over.
Mesh read_glb(const FileView& file) {
  const std::string_view bytes = file.bytes();
  const std::size_t length = check_header(file);
  std::optional<std::string_view> json, binary;
  for (std::size_t at = kHeader; length - at >= kChunkHeader;) {
    const std::size_t chunk = number_at(bytes, at), left = length - at - kChunkHeader;
    const std::uint32_t type = number_at(bytes, at + 4);
    if (chunk > left)
      file.fail(at_byte(at), "a chunk of " + std::to_string(chunk) + " bytes, where " + std::to_string(left) +
                                 " are left; the file is cut off or damaged, get all of it");
    const std::string_view content = bytes.substr(at + kChunkHeader, chunk);
    if (!json && type != kJson) file.fail(at_byte(at + 4), "the first chunk is not its JSON; write the file again");
    if (!json)
      json = content;
    else if (type == kBinary && !binary)
      binary = content;
    at = next_chunk(bytes, at + kChunkHeader + chunk, length);
  }
  return read_scene(file, *json, binary);
}

}  // namespace standoff
