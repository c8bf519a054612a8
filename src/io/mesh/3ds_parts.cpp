// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/3ds_parts.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>

#include "io/mesh/3ds_chunks.h"

namespace standoff {
namespace {

class PartCheck {
 public:
  explicit PartCheck(const FileView& file) : file_(file) {}

  void run() {
    constexpr std::uint16_t kMain = 0x4d4d;
    each(0, file_.size(), [this](std::uint16_t id, std::size_t at, std::size_t stop) {
      if (id == kMain) see_main(at, stop);
    });
  }

 private:
  void see_main(std::size_t begin, std::size_t end) {
    constexpr std::uint16_t kEditor = 0x3d3d;
    each(begin, end, [this](std::uint16_t id, std::size_t at, std::size_t stop) {
      if (id == kEditor) see_editor(at, stop);
    });
  }

  void see_editor(std::size_t begin, std::size_t end) {
    constexpr std::uint16_t kMaterial = 0xafff, kObject = 0x4000;
    each(begin, end, [this](std::uint16_t id, std::size_t at, std::size_t stop) {
      if (id == kMaterial) count(materials_, 5000, at, "materials; write the file again without them");
      if (id == kObject) see_object(at, stop);
    });
  }

  void see_object(std::size_t begin, std::size_t end) {
    constexpr std::uint16_t kMesh = 0x4100, kLight = 0x4600, kCamera = 0x4700;
    const std::size_t zero = file_.bytes().find('\0', begin);  // of its name, which may reach past it
    if (zero >= end) return;                                   // nothing is left of it
    each(zero + 1, end, [this](std::uint16_t id, std::size_t at, std::size_t stop) {
      if (id == kMesh) count(meshes_, 20'000, at, "meshes; join some of them");
      if (id == kMesh) see_mesh(at, stop);
      if (id == kLight || id == kCamera)
        count(others_, 1000, at, "lights and cameras; write the file again without them");
    });
  }

  void see_mesh(std::size_t begin, std::size_t end) {
    constexpr std::uint16_t kFaces = 0x4120, kGroup = 0x4130;
    each(begin, end, [this](std::uint16_t id, std::size_t at, std::size_t stop) {
      if (id != kFaces || stop - at < 2) return;
      const std::size_t groups = at + 2 + 8 * std::size_t{number_at<std::uint16_t>(file_.bytes(), at)};
      each(groups, stop, [this](std::uint16_t group, std::size_t place, std::size_t) {
        if (group == kGroup) count(groups_, 100'000, place, "groups of faces; write the file again without materials");
      });
    });
  }

  // Chunks longer than what holds them could make each begin all that follow.
  template <class See>
  void each(std::size_t begin, std::size_t end, const See& see) {
    each_chunk(file_, begin, end, [&](std::uint16_t id, std::size_t at, std::size_t stop) {
      count(chunks_, file_.size(), at, "chunks, which reach into each other; the file is damaged, write it again");
      see(id, at, stop);
    });
  }

  void count(std::size_t& number, std::size_t most, std::size_t at, const char* what) const {
    if (++number > most) file_.fail("byte " + std::to_string(at), "more than " + std::to_string(most) + " " + what);
  }

  const FileView& file_;
  std::size_t chunks_ = 0, materials_ = 0, meshes_ = 0, groups_ = 0, others_ = 0;
};

}  // namespace

void check_3ds_parts(const FileView& file) { PartCheck(file).run(); }

}  // namespace standoff
