// The files that assimp gets to see.
#pragma once
#ifdef DIFI_HAVE_ASSIMP

#include <assimp/DefaultIOSystem.h>
#include <assimp/MemoryIOWrapper.h>

#include <cstdint>
#include <string>

#include "io/file_view.h"

namespace difi {

/// A mesh file from the bytes that were checked, whatever another program does to it meanwhile; the files it refers to,
/// such as the buffers of glTF, from the disk.
class AssimpFiles : public Assimp::DefaultIOSystem {
 public:
  /// The view must outlive it.
  explicit AssimpFiles(const FileView& file) : file_(file), name_(file.path().string()) {}

  bool Exists(const char* name) const override { return name == name_ || DefaultIOSystem::Exists(name); }
  Assimp::IOStream* Open(const char* name, const char* mode) override {
    if (name != name_) return DefaultIOSystem::Open(name, mode);
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(file_.bytes().data()), file_.size());
  }

 private:
  const FileView& file_;
  std::string name_;
};

}  // namespace difi

#endif  // DIFI_HAVE_ASSIMP
