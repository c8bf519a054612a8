// SPDX-License-Identifier: Apache-2.0
// Input: open files of the system, pipes, streams and their lines; the bytes of a file at once or front to back.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace standoff {

/// An open file, which the destructor closes; a number below zero stands for none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  /// Hands the open file over to the caller.
  int release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

// Opening a named pipe may wait for its other end. The wait can be stopped, and is reported.

class ProgressMeter;

/// Opens what is read from front to back. Of a pipe it waits until something comes through it, or its writer has gone;
/// meanwhile `waiting`, if there is one, may stop it (Error{interrupted}). As ::open: below zero with errno.
Descriptor open_to_read(const std::filesystem::path& path, ProgressMeter* waiting = nullptr);

/// Opens a pipe or device that is there, which the caller calls `shown`. Of a pipe it waits until somebody reads it. As
/// ::open.
Descriptor open_to_write(const std::filesystem::path& path, const std::filesystem::path& shown);

/// Sets the function that gets a sentence, "FILE: ..", once an open has waited for a pipe for a second. By default
/// there is none: a library prints nothing. Set it before any thread opens a file.
void set_pipe_notice(void (*notice)(const std::string& sentence)) noexcept;

// Input that is read front to back and never held as a whole: files larger than memory, pipes, the standard input.

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

// The lines of tables in text: poses, motions, points. Of any length in all, in constant memory.

/// Lines end with LF or CR LF, or with CR where the first of them ends so. What follows a # is a comment. A mark of
/// UTF-8 at the beginning, as spreadsheets write it, is passed over.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  explicit LineReader(InputStream input) : input_(std::move(input)) {}

  /// The next line that has content, without its comment and the blanks at its end; it lives until the next call. False
  /// at the end of the text. Errors: input (a line longer than kLongestLine).
  bool next(std::string_view& line);
  /// The number of that line, from 1.
  std::uint64_t number() const { return number_; }
  /// Throws Error{input} "NAME:line N: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const { fail_at(number_, message); }
  /// The same of a line before it.
  [[noreturn]] void fail_at(std::uint64_t number, const std::string& message) const;
  double fraction() const { return input_.fraction(); }
  const std::string& name() const { return input_.name(); }

 private:
  bool next_raw(std::string_view& line);
  void begin();
  bool refill();

  InputStream input_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, end_ = 0;  // what is not read yet
  bool begun_ = false, ended_ = false;
  char line_end_ = '\n';
  std::uint64_t number_ = 0;
};

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
  /// Makes a view whose readers may be stopped: see check(). The meter must outlive it.
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
  void check() const;

  /// At most `bytes` bytes from `offset` on, fewer at the end of the file.
  std::string_view text(std::uint64_t offset, std::uint64_t bytes) const {
    return offset < size() ? bytes_.substr(offset, bytes) : std::string_view();
  }
  /// Says that a part of the bytes is not read again, so that pages of a mapping may leave memory. Text that is not the
  /// file's is ignored.
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

/// Returns the part of a message that says what is wrong, without what to do: for errors of a grid or a mesh that came
/// from a file.
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
