#include "io/gltf_check.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

namespace difi {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
// Ten times what scenes need; each level takes a frame of the reader's stack.
constexpr int kDeepest = 200;

std::uint32_t number_at(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

std::string at_byte(std::size_t byte) { return "byte " + std::to_string(byte); }

// Brackets outside of strings. Whether they match is the reader's to find.
void check_depth(const FileView& file, std::size_t begin, std::size_t end) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t at = begin; at < end; ++at) {
    const char c = file.bytes()[at];
    if (in_string) {
      if (c == '\\')
        ++at;
      else if (c == '"')
        in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kDeepest)
        file.fail(at_byte(at), "its JSON is nested more than " + std::to_string(kDeepest) +
                                   " deep; write the file again in the program that made it");
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

}  // namespace

void check_glb(const FileView& file) {
  const std::string_view bytes = file.bytes();
  if (!bytes.starts_with("glTF")) file.fail(at_byte(0), "a binary glTF starts with glTF; check that it is one");
  if (bytes.size() < kHeader + kChunkHeader)
    file.fail(at_byte(bytes.size()), "the file ends in its header; it is cut off, get all of it");
  if (const auto version = number_at(bytes, 4); version != 2)
    file.fail(at_byte(4), "version " + std::to_string(version) + " of glTF; convert it to version 2");
  const std::size_t length = number_at(bytes, 8);
  if (length > bytes.size() || length < kHeader + kChunkHeader)
    file.fail(at_byte(8), "it promises " + std::to_string(length) + " bytes and has " + std::to_string(bytes.size()) +
                              "; it is cut off or damaged, get all of it");
  for (std::size_t at = kHeader; length - at >= kChunkHeader;) {
    const std::size_t chunk = number_at(bytes, at), left = length - at - kChunkHeader;
    if (chunk > left)
      file.fail(at_byte(at), "a chunk of " + std::to_string(chunk) + " bytes, where " + std::to_string(left) +
                                 " are left; the file is cut off or damaged, get all of it");
    const std::size_t begin = at + kChunkHeader;
    if (at == kHeader) check_depth(file, begin, begin + chunk);
    at = std::min(length, begin + (chunk + 3) / 4 * 4);  // chunks are padded
  }
}

void check_gltf(const FileView& file) { check_depth(file, 0, file.size()); }

}  // namespace difi
