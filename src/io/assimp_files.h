// The files that assimp gets to see.
#pragma once
#ifdef DIFI_HAVE_ASSIMP

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/file_view.h"

namespace difi {

/// A mesh file from the bytes that were checked, whatever another program does to it meanwhile; the files it refers to,
/// such as the buffers of glTF, from the disk.
class AssimpFiles : public Assimp::DefaultIOSystem {
 public:
  /// The view must outlive it. The bytes at `hidden` are shown as '_'.
  AssimpFiles(const FileView& file, const std::vector<std::size_t>& hidden)
      : name_(file.path().string()), bytes_(file.bytes()) {
    if (hidden.empty()) return;
    copy_ = bytes_;
    for (const std::size_t at : hidden) copy_[at] = '_';
    bytes_ = copy_;
  }

  bool Exists(const char* name) const override { return name == name_ || DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (name != name_) return DefaultIOSystem::Open(name, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(bytes_.data()), bytes_.size());
  }

 private:
  std::string name_, copy_;
  std::string_view bytes_;
};

}  // namespace difi

#endif  // DIFI_HAVE_ASSIMP
