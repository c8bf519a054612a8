// SPDX-License-Identifier: Apache-2.0
// Reads a file front to back; nothing is read beyond its end.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff::vdb {

class Cursor {
 public:
  explicit Cursor(const FileView& file, std::uint64_t at = 0) : file_(file), at_(at) {}

  template <class Number>
  Number number() {
    const Number value = file_.number<Number>(at_);
    at_ += sizeof value;
    return value;
  }
  std::string_view bytes(std::uint64_t count, const char* what) {
    file_.require(at_, count, what);
    const std::string_view part = file_.text(at_, count);
    at_ += count;
    return part;
  }
  /// After its length.
  std::string_view text(const char* what) { return bytes(number<std::uint32_t>(), what); }
  template <class Mask>
  void mask(Mask& mask) {
    const std::string_view part = bytes(sizeof mask.words, "a mask");
    std::memcpy(mask.words.data(), part.data(), part.size());
  }

  void go_to(std::uint64_t at) { at_ = at; }
  const FileView& file() const { return file_; }
  std::uint64_t at() const { return at_; }
  [[noreturn]] void fail(const std::string& what) const { file_.fail("byte " + std::to_string(at_), what); }

 private:
  const FileView& file_;
  std::uint64_t at_;
};

}  // namespace standoff::vdb
