// SPDX-License-Identifier: Apache-2.0
// Checksums of bytes, and of bytes that repeat, without going through them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace standoff {

/// Adler-32 (RFC 1950) of what came before and `count` copies of `element`.
std::uint32_t adler32_of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count);

/// CRC-32 (RFC 1952) of what came before, at first 0, and these bytes.
std::uint32_t crc32_of(std::uint32_t before, std::span<const std::byte> bytes);

/// CRC-32 of runs.
class CrcRuns {
 public:
  /// Runs of up to `longest` elements of so many bytes.
  CrcRuns(std::size_t element_bytes, std::uint64_t longest);

  /// The checksum of what came before and `count` copies of `element`.
  std::uint32_t of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count) const;
  /// The checksum of two parts, where the second one has so many elements.
  std::uint32_t joined(std::uint32_t first, std::uint32_t second, std::uint64_t elements) const;

 private:
  // Of n elements: what a checksum is multiplied with to move past them, and what that of one element is multiplied
  // with to become theirs: the sum of the first n powers.
  struct Step {
    std::uint32_t power, sum;
  };
  Step step_of(std::uint64_t elements) const;

  std::vector<Step> fine_, coarse_;  // of n elements, and of n * kFine
};

}  // namespace standoff
