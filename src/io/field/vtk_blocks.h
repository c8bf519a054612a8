// SPDX-License-Identifier: Apache-2.0
// Arrays that VTK's XML files hold compressed: a table, and a zlib stream for each block.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "files/zip.h"

namespace standoff {

/// What the table says; all blocks lie in the file and can become what they are said to.
struct VtkBlocks {
  struct Block {
    std::uint64_t at = 0, packed = 0, bytes = 0;  ///< where it begins, its length there, and unpacked
  };
  std::vector<Block> blocks;
  std::uint64_t bytes = 0;  ///< of all blocks, unpacked
};

/// Reads the table at `at`, of numbers of 4 or 8 bytes. Errors: input.
VtkBlocks read_vtk_blocks(const FileView& file, std::uint64_t at, unsigned number_bytes, bool big_endian);

/// The bytes of an array. Memory is taken for what is asked for at once.
class VtkBlockStream : public ByteStream {
 public:
  /// All must outlive it.
  VtkBlockStream(const FileView& file, const VtkBlocks& blocks) : file_(file), blocks_(blocks) {}

  std::string_view next(std::uint64_t bytes) override;
  void finish() override {}

 private:
  const FileView& file_;
  const VtkBlocks& blocks_;
  std::size_t block_ = 0;       // that is being read
  std::uint64_t in_block_ = 0;  // bytes read of it
  std::optional<Inflater> inflater_;
  UnpackedBytes buffer_;
};

}  // namespace standoff
