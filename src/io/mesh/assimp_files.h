// SPDX-License-Identifier: Apache-2.0
// The one file that assimp gets to see.
#pragma once
#ifdef STANDOFF_HAVE_ASSIMP

#include <assimp/MemoryIOWrapper.h>
#include <assimp/IOSystem.hpp>

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include "files/file_view.h"

namespace standoff {

/// A mesh file from the bytes that were checked, whatever another program does to it meanwhile. No other file is there
/// for assimp: what a mesh refers to, such as textures, is none of its shape.
class AssimpFiles : public Assimp::IOSystem {
 public:
  /// Assimp goes by the extension of `name`, which the file's own need not have. The view must outlive it.
  AssimpFiles(const FileView& file, std::string name) : name_(std::move(name)), bytes_(file.bytes()) {}

  bool Exists(const char* name) const override { return name == name_; }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (name != name_ || *mode != 'r') return nullptr;
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size());
  }
  void Close(Assimp::IOStream* stream) override { delete stream; }

 private:
  std::string name_;
  std::string_view bytes_;
};

}  // namespace standoff

#endif  // STANDOFF_HAVE_ASSIMP
