#include "io/3ds_check.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace difi {
namespace {

constexpr std::size_t kHeader = 6;  // of a chunk: what it is, and its length with this header

// Chunks that hold each other: the file, its keyframer, a node of it, a track of positions, rotations and so on.
constexpr int kFile = 0, kTrack = 3;
bool is_of(int level, std::uint16_t id) {
  constexpr struct {
    std::uint16_t first, last;
  } kIds[kTrack + 1] = {{0x4d4d, 0x4d4d}, {0xb000, 0xb000}, {0xb001, 0xb007}, {0xb020, 0xb029}};
  return id >= kIds[level].first && id <= kIds[level].last;
}

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
  T number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
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

// Goes through chunks as assimp does: one without content is no more than its header, and one longer than what holds it
// takes what follows along.
void check_chunks(const FileView& file, int level, std::size_t begin, std::size_t end) {
  for (std::size_t at = begin; at < end && end - at >= kHeader;) {
    const auto id = number_at<std::uint16_t>(file.bytes(), at);
    const std::size_t size = number_at<std::uint32_t>(file.bytes(), at + 2);
    at += kHeader;
    if (size <= kHeader) continue;
    const std::size_t stop = at + std::min(size - kHeader, file.size() - at);
    if (is_of(level, id)) {
      if (level == kTrack)
        check_track(file, at, stop);
      else
        check_chunks(file, level + 1, at, stop);
    }
    if (stop > end) end = file.size();
    at = stop;
  }
}

}  // namespace

void check_3ds(const FileView& file) { check_chunks(file, kFile, 0, file.size()); }

}  // namespace difi
