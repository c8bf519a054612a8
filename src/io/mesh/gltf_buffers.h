// SPDX-License-Identifier: Apache-2.0
// The bytes of a glTF file's buffers, and the views through which they are looked at.
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
#include "io/mesh/json_view.h"

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

}  // namespace standoff
