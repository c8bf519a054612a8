// SPDX-License-Identifier: Apache-2.0
#include "io/field/vtk_blocks.h"

#include <algorithm>
#include <string>

namespace standoff {

VtkBlocks read_vtk_blocks(const FileView& file, std::uint64_t at, unsigned number_bytes, bool big_endian) {
  const std::string where = "byte " + std::to_string(at);
  const auto number = [&](std::uint64_t n) -> std::uint64_t {
    const std::uint64_t place = at + n * number_bytes;
    if (number_bytes == 8) {
      const auto wide = file.number<std::uint64_t>(place);
      return big_endian ? __builtin_bswap64(wide) : wide;
    }
    const auto narrow = file.number<std::uint32_t>(place);
    return big_endian ? __builtin_bswap32(narrow) : narrow;
  };
  const std::uint64_t count = number(0);
  if (count == 0) return {};
  const std::uint64_t full = number(1), last = number(2);
  constexpr std::uint64_t kFixed = 3;
  if (count > file.size() / number_bytes) file.fail(where, "a table of more blocks than fit; write the file again");
  file.require(at, (kFixed + count) * number_bytes, "a table of blocks");
  if (full == 0 || last > full) file.fail(where, "a table of blocks without a size; write the file again");
  VtkBlocks found;
  std::uint64_t place = at + (kFixed + count) * number_bytes;
  for (std::uint64_t n = 0; n < count; ++n) {
    const std::uint64_t packed = number(kFixed + n), bytes = n + 1 == count && last > 0 ? last : full;
    file.require(place, packed, "a block");
    if (bytes / kMostDeflated > packed)
      file.fail("byte " + std::to_string(place),
                "a block so short cannot hold what is said of it; write the file again");
    found.blocks.push_back({place, packed, bytes});
    found.bytes += bytes;
    place += packed;
  }
  return found;
}

std::string_view VtkBlockStream::next(std::uint64_t bytes) {
  char* const to = buffer_.room(bytes);
  for (std::uint64_t done = 0; done < bytes;) {
    const VtkBlocks::Block& block = blocks_.blocks.at(block_);
    if (!inflater_)
      inflater_.emplace(file_, "byte " + std::to_string(block.at), file_.text(block.at, block.packed),
                        Inflater::Wrapper::zlib);
    const std::uint64_t part = std::min(bytes - done, block.bytes - in_block_);
    inflater_->fill(to + done, part);
    done += part;
    in_block_ += part;
    if (in_block_ < block.bytes) continue;
    // The checksum is behind the last byte; what follows is not part of the array.
    char more;
    if (inflater_->read(&more, 1) != 0)
      file_.fail("byte " + std::to_string(block.at), "a block unpacks to more than is said; write the file again");
    inflater_.reset();
    in_block_ = 0;
    ++block_;
  }
  return {to, bytes};
}

}  // namespace standoff
