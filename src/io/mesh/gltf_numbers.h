// SPDX-License-Identifier: Apache-2.0
// The numbers of a glTF file: accessors, the views of buffers they look through, and the buffers' bytes.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/gltf_buffers.h"
#include "io/mesh/json_view.h"
#include "standoff/vec.h"

namespace standoff {

/// Reads what accessors hold, those that are asked for: whatever is wrong with texture coordinates, it fails nothing.
/// Errors everywhere: input, as `FILE:accessor N: ...`, for what is out of range, missing
/// or of the wrong kind.
class GltfNumbers {
 public:
  /// `accessors` is the file's list of that name, where there is one. The buffers must outlive it.
  GltfNumbers(const FileView& file, const std::optional<JsonView>& accessors, GltfBuffers& buffers);

  /// Elements of an accessor.
  std::uint64_t count(std::uint64_t accessor) { return find(accessor).count; }
  /// Reads the buffers an accessor needs, and makes sure that its numbers lie in them.
  void require(std::uint64_t accessor);
  /// Appends the positions of an accessor: of three floats, or of integers as KHR_mesh_quantization allows.
  void read_positions(std::uint64_t accessor, std::vector<Vec3>& positions);
  /// Replaces `indices` by the numbers of an accessor of whole numbers.
  void read_indices(std::uint64_t accessor, std::vector<std::uint32_t>& indices);

 private:
  enum class Type : std::uint16_t { int8 = 5120, uint8, int16, uint16, uint32 = 5125, float32 };

  struct Sparse {
    std::uint64_t count;
    GltfPlace indices, values;
    Type index_type;
  };
  struct Accessor {
    std::optional<GltfPlace> place;  // none: zeros
    std::uint64_t count;
    std::size_t sparse;  // its number in sparse_, from 1 on; 0 for none
    Type type;
    std::uint8_t width;  // numbers in an element
    bool normalized;
  };

  std::string name(std::uint64_t accessor) const { return "accessor " + std::to_string(accessor); }
  const Accessor& find(std::uint64_t accessor);
  Accessor accessor(std::uint64_t number);
  Sparse sparse(std::uint64_t number, const JsonView& json, std::uint64_t count) const;

  template <class Body>
  static void with_type(Type type, const Body& body);
  template <class Put>
  void each_number(std::uint64_t accessor, const Put& put);
  template <class Put>
  void each_sparse_number(std::uint64_t number, const Put& put);

  const FileView& file_;
  GltfBuffers& buffers_;
  std::vector<JsonView> accessors_;
  std::map<std::uint64_t, Accessor> read_;  // those asked for
  std::vector<Sparse> sparse_;
};

}  // namespace standoff
