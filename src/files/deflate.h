// SPDX-License-Identifier: Apache-2.0
// Deflates (RFC 1951): numbers of which many repeat the one before by a coder of our own, bytes of any kind by zlib.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/checksums.h"

namespace standoff {

// Runs are given as such and cost nothing, whatever their length. What is between runs is coded byte by byte; longer
// patterns, of which samples have few, are not looked for.

class RunDeflater {
 public:
  /// For elements of so many bytes, at most 256.
  explicit RunDeflater(std::size_t element_bytes) : period_(element_bytes) {}

  /// Forgets all that was added.
  void clear();
  /// Adds `count` elements.
  void elements(const std::byte* from, std::uint64_t count);
  /// Adds `count` copies of an element. In all, fewer than 2^31 bytes may be added.
  void run(const std::byte* element, std::uint64_t count);
  std::uint64_t bytes() const { return literals_.size() + run_bytes_; }

  enum class End {
    more,  ///< other deflated bytes may follow: ends with a byte
    last,  ///< the stream ends
  };
  /// Appends to `out` what was added, deflated. It refers to nothing before it.
  void deflate(std::string& out, End end) const;

  /// What was added as a zlib stream of its own (RFC 1950).
  std::string zlib() const;

  /// Of all that was added.
  std::uint32_t adler32() const;
  std::uint32_t crc32(const CrcRuns& runs) const;

 private:
  // Literal bytes, whole elements, and then bytes of copies of the last one.
  struct Token {
    std::uint32_t literals = 0, run = 0;
  };
  template <std::size_t bytes>
  void add_elements(const std::byte* from, std::uint64_t count);
  void add_literals(const std::byte* from, std::uint64_t count);
  void add_run(std::uint64_t count);
  void store(std::string& out, End end) const;
  std::string all() const;
  template <class Literals, class Run>
  void each_token(Literals literals, Run run) const;

  std::size_t period_;
  std::vector<std::byte> literals_;
  std::vector<Token> tokens_;
  std::uint64_t run_bytes_ = 0;
};

/// A few bytes as a zlib stream.
std::string zlib_stream(std::string_view bytes);

/// The bytes as a zlib stream. `level`: 0 (stored) to 9 (smallest), as zlib has them.
std::string zlib_packed(std::string_view bytes, int level);

}  // namespace standoff
