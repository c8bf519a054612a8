// SPDX-License-Identifier: Apache-2.0
// The bytes of an input file, all at once or front to back, and how messages show them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/progress.h"
#include "files/descriptor.h"

namespace standoff {

/// A file's bytes for as long as the view lives, and the errors about them.
class FileView {
 public:
  enum class Access {
    copy,  ///< read to its end: what another program does to the file meanwhile does not matter
    /// Nothing is copied, and the system may drop pages that are not in use: for files larger than memory. A program
    /// that shortens the file meanwhile ends ours with SIGBUS, as with every mapping. Pipes are copied all the same.
    map,
  };

  /// Errors: input, for files that are missing, folders, devices, or unreadable; limit, for those that memory
  /// cannot hold, and for more from a pipe than a quarter of the machine's memory.
  explicit FileView(const std::filesystem::path& path, Access access = Access::copy)
      : FileView(path, access, nullptr) {}
  /// One whose readers may be stopped: see check(). The meter must outlive it.
  FileView(const std::filesystem::path& path, Access access, ProgressMeter& waiting)
      : FileView(path, access, &waiting) {}
  /// The bytes of an open file, `longest` at the most; `name` stands in messages. Errors: as above.
  FileView(const std::filesystem::path& name, const Descriptor& file, std::uint64_t longest);
  /// A view of the caller's bytes, which must outlive it; messages contain `name`.
  FileView(const std::filesystem::path& name, std::string_view bytes) : path_(name), bytes_(bytes) {}
  /// The same of a part of another file, whose waiting caller it keeps.
  FileView(const FileView& whole, const std::filesystem::path& name, std::string_view bytes)
      : path_(name), bytes_(bytes), waiting_(whole.waiting_) {}
  /// Takes bytes that were made of those of a file, whose name and whose waiting caller they keep.
  FileView(const FileView& packed, std::unique_ptr<char[]> bytes, std::size_t size)
      : path_(packed.path_), bytes_(bytes.get(), size), waiting_(packed.waiting_), read_(std::move(bytes)) {}
  FileView(const FileView&) = delete;
  FileView& operator=(const FileView&) = delete;
  ~FileView();

  const std::filesystem::path& path() const { return path_; }
  std::string_view bytes() const { return bytes_; }
  std::size_t size() const { return bytes_.size(); }

  /// Throws Error{interrupted} once the caller who waits for what is read has asked to stop. Readers call it every few
  /// milliseconds, from any thread.
  void check() const {
    if (waiting_) waiting_->check();
  }

  /// At most `bytes` bytes from `offset` on, fewer at the end of the file.
  std::string_view text(std::uint64_t offset, std::uint64_t bytes) const {
    return offset < size() ? bytes_.substr(offset, bytes) : std::string_view();
  }
  /// Says that a part of the bytes is not looked at again: of a mapping its pages leave our memory. Other text than the
  /// file's is passed over.
  void forget(std::string_view part) const;
  /// The number whose bytes, little endian, begin at `offset`. Errors: input, where the file ends before.
  template <class Number>
  Number number(std::uint64_t offset) const {
    require(offset, sizeof(Number), "a number");
    Number number;
    std::memcpy(&number, bytes_.data() + offset, sizeof number);
    return number;
  }
  /// Throws Error{input} unless the file holds `bytes` bytes from `offset` on; `what` names them in the message.
  void require(std::uint64_t offset, std::uint64_t bytes, const char* what) const {
    if (offset > size() || bytes > size() - offset) fail_short(offset, bytes, what);
  }

  /// Throws Error{input} "FILE:WHERE: MESSAGE", or "FILE: MESSAGE" where `where` is empty.
  [[noreturn]] void fail(const std::string& where, const std::string& message) const;
  [[noreturn]] void fail(const std::string& message) const { fail("", message); }

 private:
  FileView(const std::filesystem::path& path, Access access, ProgressMeter* waiting);
  [[noreturn]] void fail_short(std::uint64_t offset, std::uint64_t bytes, const char* what) const;
  // Up to the end or to `longest` bytes; more than `most` is an error.
  void read_all(int descriptor, std::size_t expected, std::size_t longest, std::size_t most);

  std::filesystem::path path_;
  std::string_view bytes_;
  ProgressMeter* waiting_ = nullptr;
  std::unique_ptr<char[]> read_;
  void* mapped_ = nullptr;
};

/// What a message says is wrong, without what it says to do: for those of a grid or a mesh that came from a file.
constexpr std::string_view diagnosis(std::string_view message) { return message.substr(0, message.find("; ")); }

/// A part of a file, unpacked as it is read. Errors: input, as `FILE:WHERE: ...`, for bytes that are missing or
/// damaged.
class ByteStream {
 public:
  ByteStream() = default;
  ByteStream(const ByteStream&) = delete;
  ByteStream& operator=(const ByteStream&) = delete;
  virtual ~ByteStream() = default;

  /// The next bytes, so many and no fewer. They live until the next call, or as long as the file's view.
  virtual std::string_view next(std::uint64_t bytes) = 0;
  /// Reads what is left, and checks the whole where the file holds a checksum.
  virtual void finish() = 0;
};

/// Room for what is unpacked next. Its pages are taken as they are written, so that a file that promises far more than
/// it holds is refused for the time and the memory of what it holds.
class UnpackedBytes {
 public:
  /// At least so many bytes, not set to anything. What was there before is lost.
  char* room(std::uint64_t bytes) {
    if (bytes > size_) {
      bytes_.reset();  // what is there is not kept beside it
      bytes_ = std::make_unique_for_overwrite<char[]>(bytes);
      size_ = bytes;
    }
    return bytes_.get();
  }

 private:
  std::unique_ptr<char[]> bytes_;
  std::uint64_t size_ = 0;
};

/// Bytes that lie in memory.
class BytesInMemory : public ByteStream {
 public:
  explicit BytesInMemory(std::string_view bytes) : left_(bytes) {}
  std::string_view next(std::uint64_t bytes) override {
    const std::string_view part = left_.substr(0, bytes);
    left_.remove_prefix(part.size());
    return part;
  }
  void finish() override {}

 private:
  std::string_view left_;
};

/// The text's first characters, `longest` at the most; bytes that are not printable as '?'. A file can hold anything,
/// also a megabyte without a space or what a terminal takes for a command.
std::string shown(std::string_view text, std::size_t longest = 40);

/// Its first 40 characters between quotes.
std::string in_quotes(std::string_view text);

}  // namespace standoff
