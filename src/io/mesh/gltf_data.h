// SPDX-License-Identifier: Apache-2.0
// What the numbers of a glTF file are: accessors, the views of buffers they look through, and the buffers' bytes.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "files/json_view.h"
#include "io/mesh/stored_type.h"
#include "standoff/vec.h"

namespace standoff {

/// A view by its number, and where in it.
struct GltfPlace {
  std::uint64_t view, offset;
};
/// The members "bufferView" and "byteOffset" of an object. Errors: input.
GltfPlace gltf_place(const JsonView& json);

/// Groups of bytes, one every `stride`.
struct GltfRows {
  const char* first;
  std::uint64_t stride;
};

/// Buffers come from the binary part of a GLB, from data URIs, or from files in the mesh's folder; each is read when it
/// is first looked at, and kept. Images are never opened. Errors everywhere: input, as `FILE:buffer N: ...`.
class GltfBuffers {
 public:
  /// The file's lists "buffers" and "bufferViews", where there are such, and the binary part of a GLB.
  GltfBuffers(const FileView& file, const std::optional<JsonView>& buffers, const std::optional<JsonView>& views,
              std::optional<std::string_view> binary);

  /// `count` groups of `bytes` bytes: they lie in their view, it in its buffer, that in its file. `where` stands in
  /// messages.
  GltfRows rows(const GltfPlace& place, std::uint64_t count, std::uint64_t bytes, const std::string& where);
  /// Bytes of the files beside the mesh's that were read so far.
  std::uint64_t companion_bytes() const { return companion_bytes_; }

 private:
  struct View {
    std::uint64_t buffer, offset, length, stride;  // stride 0: one group after the other
  };
  struct Buffer {
    JsonView json;
    std::uint64_t length;
    const char* bytes;  // nullptr until it is read
  };

  const char* read(std::uint64_t buffer);
  std::string_view content(std::uint64_t buffer, const std::string& where);

  const FileView& file_;
  std::optional<std::string_view> binary_;
  std::vector<Buffer> buffers_;
  std::uint64_t longest_ = 0;  // of all buffers: no file is read beyond
  std::vector<View> views_;
  std::deque<std::string> data_;                                 // of data URIs
  std::map<std::string, std::unique_ptr<FileView>> companions_;  // by path: several buffers may lie in one file
  std::uint64_t companion_bytes_ = 0;
};

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
  struct Sparse {
    std::uint64_t count;
    GltfPlace indices, values;
    StoredType index_type;
  };
  struct Accessor {
    std::optional<GltfPlace> place;  // none: zeros
    std::uint64_t count;
    std::size_t sparse;  // its number in sparse_, from 1 on; 0 for none
    StoredType type;
    std::uint8_t width;  // numbers in an element
    bool normalized;
  };

  std::string name(std::uint64_t accessor) const { return "accessor " + std::to_string(accessor); }
  const Accessor& find(std::uint64_t accessor);
  Accessor accessor(std::uint64_t number);
  Sparse sparse(std::uint64_t number, const JsonView& json, std::uint64_t count) const;

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
