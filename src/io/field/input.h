// A field file being read: any part of it, never past its end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>

#include "files/file_view.h"

namespace standoff {

/// Bounds-checked access to a view, which must outlive it. Every member that can fail throws Error{input} as
/// `FILE:WHERE: what; what to do`.
class FieldInput {
 public:
  /// A limit of 0 bytes is none.
  explicit FieldInput(const FileView& view, std::int64_t memory_limit = 0) : view_(view), memory_limit_(memory_limit) {}

  const FileView& view() const { return view_; }
  const std::filesystem::path& path() const { return view_.path(); }
  std::uint64_t size() const { return view_.size(); }
  /// Most bytes that the field in memory may take; 0: as many as it needs.
  std::int64_t memory_limit() const { return memory_limit_; }
  /// Fills `bytes` from the file.
  void read(std::uint64_t offset, std::span<std::byte> bytes) const {
    require(offset, bytes.size(), "data");
    std::memcpy(bytes.data(), view_.bytes().data() + offset, bytes.size());
  }
  template <class T>
  T read(std::uint64_t offset) const {
    T value;
    read(offset, std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }
  /// At most `bytes` bytes from `offset` on, fewer at the end of the file. Lives as long as the view.
  std::string_view text(std::uint64_t offset, std::uint64_t bytes) const {
    return offset < size() ? view_.bytes().substr(offset, bytes) : std::string_view();
  }
  /// Throws unless the file holds `bytes` bytes from `offset` on; `what` names them in the message.
  void require(std::uint64_t offset, std::uint64_t bytes, const char* what) const {
    if (offset > size() || bytes > size() - offset) fail_short(offset, bytes, what);
  }
  [[noreturn]] void fail(const std::string& where, const std::string& what) const { view_.fail(where, what); }
  [[noreturn]] void fail(const std::string& what) const { view_.fail("", what); }

 private:
  [[noreturn]] void fail_short(std::uint64_t offset, std::uint64_t bytes, const char* what) const;

  const FileView& view_;
  std::int64_t memory_limit_;
};

}  // namespace standoff
