// SPDX-License-Identifier: Apache-2.0
// Checksums of bytes that repeat, without going through them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace standoff {

/// Adler-32 (RFC 1950) of what came before and `count` copies of `element`.
std::uint32_t adler32_of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count);

/// CRC-32 (RFC 1952) of runs of known elements.
class CrcRuns {
 public:
  /// Runs of up to `longest` copies of elements that are asked for often; all have the same length. Others may be asked
  /// for too, and take time that grows with the run.
  CrcRuns(std::span<const std::string> elements, std::uint64_t longest);

  /// The checksum of what came before and `count` copies of `element`.
  std::uint32_t of_run(std::uint32_t before, std::span<const std::byte> element, std::uint64_t count) const;
  /// The checksum of two parts, where the second one has so many elements.
  std::uint32_t joined(std::uint32_t first, std::uint32_t second, std::uint64_t elements) const;

 private:
  // A run of n copies: its checksum, and what bytes before it must be multiplied with to move past it.
  struct Known {
    std::string element;
    std::vector<std::uint32_t> fine, coarse;
  };
  std::vector<std::uint32_t> fine_, coarse_;  // x^(8 * bytes) of n elements, and of n * kFine
  std::vector<Known> known_;
};

}  // namespace standoff
