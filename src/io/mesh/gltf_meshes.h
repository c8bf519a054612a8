// SPDX-License-Identifier: Apache-2.0
// The meshes of a glTF file: what of them is surface.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/mesh/builder.h"
#include "io/mesh/gltf_numbers.h"
#include "io/mesh/json_view.h"
#include "io/mesh/scene.h"

namespace standoff {

/// Lists, strips and fans of triangles; points and lines are passed over. Materials, skins and morph targets are left
/// out. Errors everywhere: input, as `FILE:mesh N primitive N: ...`.
class GltfMeshes {
 public:
  /// Of the file's list "meshes", where there is one. The numbers must outlive it.
  GltfMeshes(const FileView& file, const std::optional<JsonView>& meshes, GltfNumbers& numbers);

  /// What placing a mesh once adds; its buffers are read and found to hold it.
  Unfolded size(std::uint64_t mesh);

  /// Adds a mesh at its place. Corners turn the other way round where the placement mirrors, as the specification
  /// demands, so that what was outside stays outside.
  void place(std::uint64_t mesh, const Placement& placement, MeshBuilder& builder);

  /// Where the vertices of a builder came from, for messages.
  std::string place_of_vertex(std::size_t vertex) const;

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  enum class Mode : std::uint8_t { list = 4, strip, fan };

  struct Primitive {
    std::uint64_t positions, indices;  // accessors
    std::uint32_t number;              // in its mesh
    Mode mode;
  };
  struct Mesh {
    std::size_t first, last;  // in primitives_
    Unfolded size;
    bool required = false;
  };
  // Vertices of a builder from here on are those of an accessor.
  struct Origin {
    std::size_t first;
    std::uint64_t accessor;
  };

  Mesh& find(std::uint64_t mesh);
  std::string name(std::uint64_t mesh, std::uint32_t primitive) const;
  void add_mesh(const JsonView& json);
  void add_primitive(const JsonView& json, std::uint32_t number);
  std::uint64_t triangles(std::uint64_t corners, Mode mode, const std::string& where) const;
  void add_triangles(const Primitive& primitive, std::uint32_t first, bool mirrored, MeshBuilder& builder) const;

  const FileView& file_;
  GltfNumbers& numbers_;
  std::vector<Mesh> meshes_;
  std::vector<Primitive> primitives_;
  std::vector<std::uint32_t> corners_;  // of the primitive at hand
  std::vector<Origin> origins_;
};

}  // namespace standoff
