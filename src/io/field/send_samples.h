// SPDX-License-Identifier: Apache-2.0
// The samples of an array on their way into a file: block by block, as they are or deflated on all cores.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "io/field/field_source.h"

namespace standoff {

/// Takes bytes in order.
using ByteSink = std::function<void(std::span<const std::byte>)>;

/// Passes on all elements of an array.
void send_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part, const ByteSink& sink);

/// Elements in each deflated block but the last.
std::int64_t block_elements(const SampleArray& array, const ArrayPart& part);

enum class BlockKind {
  zlib,     ///< each a zlib stream of its own (RFC 1950)
  deflate,  ///< parts of a deflate stream that the caller ends
};
struct PackedBlock {
  std::string bytes;
  std::uint32_t crc = 0;  ///< CRC-32 of all unpacked bytes up to its end; of BlockKind::deflate
};

struct PackOptions {
  BlockKind kind = BlockKind::zlib;
  int threads = 0;
  std::uint32_t crc = 0;  ///< CRC-32 of what came before
};
/// Deflates all elements of an array, and hands the blocks over in order, one at a time. A block depends on its
/// elements alone. Memory: a few blocks for each thread.
void pack_samples(const FieldSource& source, const SampleArray& array, const ArrayPart& part,
                  const PackOptions& options, const std::function<void(const PackedBlock&)>& take);

/// Ends a stream of BlockKind::deflate.
inline constexpr std::string_view kDeflateEnd{"\x03\x00", 2};

}  // namespace standoff
