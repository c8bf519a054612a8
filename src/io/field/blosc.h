// SPDX-License-Identifier: Apache-2.0
// Unpacks what Blosc packs as OpenVDB does: LZ4, bytes shuffled. Own code, 100 lines, so that every build reads the
// files that OpenVDB writes by default, and a damaged one is an error.
// https://github.com/Blosc/c-blosc/blob/main/README_CHUNK_FORMAT.rst
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff::vdb {

/// No byte that LZ4 packed becomes more than this many: a length of n bytes says 255 n and a little.
inline constexpr std::uint64_t kMostBlosc = 255;

/// Fills `to`, which must be all that was packed. Errors: input, also for other codecs.
void unpack_blosc(const FileView& file, const std::string& where, std::string_view packed, std::span<char> to);

}  // namespace standoff::vdb
