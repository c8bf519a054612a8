// SPDX-License-Identifier: Apache-2.0
// Input that is read front to back and never held as a whole: files larger than memory, pipes, the standard input.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "files/descriptor.h"

namespace standoff {

/// Why a file cannot be read, and what to do, for a number of errno.
std::string cannot_read(int error);

class InputStream {
 public:
  /// Opens a file or a pipe; "-" is the standard input. Errors: input.
  explicit InputStream(const std::string& name);
  /// The caller's bytes, which must outlive it.
  InputStream(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes), size_(bytes.size()) {}

  /// Fills `to` with up to `room` bytes and returns how many they are: 0 at the end alone. Errors: input.
  std::size_t read(char* to, std::size_t room);
  /// What messages call it.
  const std::string& name() const { return name_; }
  /// The finished share, 0 to 1; 0 where the end is unknown.
  double fraction() const { return size_ > 0 ? static_cast<double>(done_) / static_cast<double>(size_) : 0; }

 private:
  std::string name_;
  std::string_view bytes_;  // what is left of the caller's
  Descriptor opened_;       // not that of the standard input, which stays open
  int file_ = -1;           // none: the caller's bytes
  std::uint64_t size_ = 0, done_ = 0;
};

}  // namespace standoff
