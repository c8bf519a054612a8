// SPDX-License-Identifier: Apache-2.0
// Parts of glTF files: their data, the frame of a GLB, trees of nodes that are none.
#pragma once

#include <string>
#include <vector>

#include "tests/grammar/file.h"
#include "tests/grammar/json.h"

namespace standoff::grammar {

/// Buffers, views and accessors.
class GltfData {
 public:
  GltfData(Choices& c, bool binary);

  /// Adds numbers and returns the number of their accessor.
  Json positions(const std::vector<Vec3>& points);
  Json indices(const std::vector<std::uint32_t>& numbers, std::size_t points);

  /// Moves all into the document, and files of buffers beside the file.
  void finish(Json& json, File& file);
  /// The bytes of the first buffer, where that is GLB's own.
  const std::string& chunk() const { return chunk_; }

 private:
  Json accessor(const std::vector<std::string>& elements, std::uint32_t component, const char* type, bool may_stride);

  Choices& c_;
  bool binary_;
  std::vector<std::string> buffers_;
  std::string chunk_;
  Json views_ = Json::list(), accessors_ = Json::list();
};

/// The header and the chunks.
std::string make_glb_bytes(Choices& c, std::string json, const std::string& data);

/// Hangs more nodes onto the last root of the last scene: a chain deeper than a stack, nodes that list the next one
/// twice and so stand for 2^40, a circle, one child a hundred thousand times.
void hang(Json& json, Choices& c);

}  // namespace standoff::grammar
