// SPDX-License-Identifier: Apache-2.0
// The compression of chunks: blosc, where this build has it.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace standoff::zarr {

/// What every writer of ours says of it in the metadata, too.
inline constexpr int kBloscLevel = 3, kNumberBytes = 4;

/// Whether this build can compress and decompress.
bool have_blosc();
/// What to do where it cannot, to end a message.
inline constexpr const char* kWithoutBlosc =
    "this build of standoff lacks blosc; build it where blosc is found (Debian: libblosc-dev)";

/// Compresses numbers of 4 bytes: zstd of the bytes shuffled, in blocks of so many bytes; 0: as blosc chooses them. The
/// result depends on the arguments alone. Requires have_blosc(), and at most 2^30 bytes.
std::vector<std::byte> blosc_packed(std::span<const std::byte> bytes, int level = kBloscLevel, std::size_t block = 0);

/// The most bytes that `bytes` bytes become.
std::size_t blosc_most(std::size_t bytes);

/// Unpacks what must become exactly out.size() bytes. Returns what is wrong, empty if nothing is. Requires
/// have_blosc().
std::string blosc_unpack(std::string_view packed, std::span<std::byte> out);

}  // namespace standoff::zarr
