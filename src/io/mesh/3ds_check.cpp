// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/3ds_check.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/mesh/3ds_chunks.h"
#include "io/mesh/3ds_parts.h"

namespace standoff {
namespace {

// Chunks that hold each other: the file, its keyframer, a node of it, a track of positions, rotations and so on.
constexpr int kFile = 0, kTrack = 3;
bool is_of(int level, std::uint16_t id) {
  constexpr struct {
    std::uint16_t first, last;
  } kIds[kTrack + 1] = {{0x4d4d, 0x4d4d}, {0xb000, 0xb000}, {0xb001, 0xb007}, {0xb020, 0xb029}};
  return id >= kIds[level].first && id <= kIds[level].last;
}

void check_track(const FileView& file, std::size_t begin, std::size_t end) {
  constexpr std::size_t kBefore = 10, kLeastKey = 6;  // a key: the frame's number, its flags, values
  if (begin + kBefore + 4 > end) return;              // assimp tells
  const auto keys = number_at<std::uint32_t>(file.bytes(), begin + kBefore);
  if (keys > (end - begin - kBefore - 4) / kLeastKey)
    file.fail("byte " + std::to_string(begin + kBefore),
              "a track of " + std::to_string(keys) + " keys, where " + std::to_string(end - begin - kBefore - 4) +
                  " bytes are left; the file is cut off or damaged, get all of it");
}

// The tree that assimp makes of the keyframer's nodes, as deep as it can be: assimp calls itself for every level, and
// looks for every node's name among all before it.
class NodeCheck {
 public:
  // `kind` is the chunk around the name, which begins at `begin`.
  void see(const FileView& file, std::uint16_t kind, std::size_t begin, std::size_t end) {
    constexpr std::uint16_t kObject = 0xb002;
    constexpr std::size_t kMostNodes = 10'000, kDeepest = 1000;
    if (++nodes_ > kMostNodes)
      file.fail("byte " + std::to_string(begin), "more than " + std::to_string(kMostNodes) +
                                                     " nodes in its keyframes; write the file again without animation");
    const std::size_t zero = std::min(file.bytes().find('\0', begin), end), place = zero + 5;
    if (place + 2 > file.size()) return;  // assimp reports it
    add(static_cast<std::uint16_t>(number_at<std::uint16_t>(file.bytes(), place) + 1));
    // A camera or a light that has the name of a node goes on from there: from now on any node may be a level of its
    // own.
    anywhere_ |= kind != kObject;
    if (open_.size() + deeper_ > kDeepest)
      file.fail("byte " + std::to_string(begin),
                "its nodes are nested too deep; flatten the scene in the program that wrote it");
  }

 private:
  // Assimp's rule: beside the node before, below it, or back beside the latest one at that place.
  void add(std::uint16_t place) {
    // Assimp keeps places as signed 16-bit numbers: above this none equals the place before it.
    constexpr std::uint16_t kHighest = 0x7fff;
    if (anywhere_) {
      ++deeper_;
    } else if (!open_.empty() && open_.back() == place && place <= kHighest) {
      ++last_;
    } else if (place >= last_) {
      open_.push_back(place);
      last_ = static_cast<std::int16_t>(place);
    } else {
      while (open_.size() > 1 && open_.back() != place) open_.pop_back();
      if (open_.back() != place) open_ = {place};
      ++last_;
    }
  }

  std::vector<std::uint16_t> open_;  // places of the latest node and of those above it
  std::int16_t last_ = -1;
  std::size_t nodes_ = 0, deeper_ = 0;
  bool anywhere_ = false;
};

void check_keyframes(const FileView& file, NodeCheck& nodes, std::uint16_t around, int level, std::size_t begin,
                     std::size_t end) {
  constexpr std::uint16_t kNodeName = 0xb010;
  each_chunk(file, begin, end, [&](std::uint16_t id, std::size_t at, std::size_t stop) {
    if (is_of(level, id)) {
      if (level == kTrack)
        check_track(file, at, stop);
      else
        check_keyframes(file, nodes, id, level + 1, at, stop);
    }
    if (level == kTrack && id == kNodeName) nodes.see(file, around, at, stop);
  });
}

}  // namespace

void check_3ds(const FileView& file) {
  NodeCheck nodes;
  check_keyframes(file, nodes, 0, kFile, 0, file.size());
  check_3ds_parts(file);
}

}  // namespace standoff
