// SPDX-License-Identifier: Apache-2.0
#include "files/file_view.h"

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <functional>
#include <limits>
#include <new>
#include <optional>

#include "standoff/error.h"

namespace standoff {
namespace {

constexpr std::size_t kUnbounded = std::numeric_limits<std::size_t>::max();

// A quarter of the memory, for while it grows it is there twice: what comes through a pipe may have no end, and all
// memory would be taken before a larger piece is refused.
std::size_t most_of_a_pipe() {
  return static_cast<std::size_t>(::sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) / 4;
}

// The number in "line 12".
std::optional<std::int64_t> number_after(std::string_view word, std::string_view where) {
  std::int64_t number = 0;
  if (!where.starts_with(word)) return std::nullopt;
  const auto [end, error] = std::from_chars(where.data() + word.size(), where.data() + where.size(), number);
  return error == std::errc{} ? std::optional(number) : std::nullopt;
}

}  // namespace

FileView::FileView(const std::filesystem::path& path, Access access, ProgressMeter* waiting)
    : path_(path), waiting_(waiting) {
  const Descriptor file = open_to_read(path, waiting);
  struct stat about {};
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) fail("", cannot_read(errno));
  if (S_ISDIR(about.st_mode)) fail("", cannot_read(EISDIR));
  if (!S_ISFIFO(about.st_mode) && !S_ISREG(about.st_mode))
    fail("", "it is a device; give the name of a file, or of a pipe");
  const auto size = static_cast<std::size_t>(about.st_size);
  const bool pipe = S_ISFIFO(about.st_mode);
  if (pipe || access == Access::copy) {
    read_all(file.number(), size, kUnbounded, pipe ? most_of_a_pipe() : kUnbounded);
    return;
  }
  if (size == 0) return;
  void* mapped = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number(), 0);
  if (mapped == MAP_FAILED) fail("", cannot_read(errno));
  mapped_ = mapped;
  bytes_ = {static_cast<const char*>(mapped), size};
}

FileView::FileView(const std::filesystem::path& name, const Descriptor& file, std::uint64_t longest) : path_(name) {
  struct stat about {};
  if (::fstat(file.number(), &about) != 0) fail("", cannot_read(errno));
  const auto most = static_cast<std::size_t>(longest);
  read_all(file.number(), std::min(static_cast<std::size_t>(about.st_size), most), most, kUnbounded);
}

FileView::~FileView() {
  if (mapped_) ::munmap(mapped_, bytes_.size());
}

void FileView::forget(std::string_view part) const {
  const std::less<const char*> before;  // any pointers may be compared
  if (!mapped_ || before(part.data(), bytes_.data()) || before(bytes_.data() + size(), part.data() + part.size()))
    return;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const auto first = static_cast<std::size_t>(part.data() - bytes_.data());
  // What stands before the part on its first page is read from the file again, should anybody ask.
  const std::size_t begin = first / page * page, end = (first + part.size()) / page * page;
  if (begin < end) (void)::madvise(static_cast<char*>(mapped_) + begin, end - begin, MADV_DONTNEED);
}

void FileView::read_all(int descriptor, std::size_t expected, std::size_t longest, std::size_t most) {
  constexpr std::size_t kLeast = std::size_t{1} << 16, kMostAtOnce = std::size_t{1} << 24;
  // One byte more than expected, so that the end is found without a larger buffer.
  std::size_t room = std::max(expected + 1, kLeast), size = 0;
  try {
    read_ = std::make_unique_for_overwrite<char[]>(room);
    while (size < longest) {
      check();
      if (size > most)
        throw Error(ErrorCode::limit, path_.string() + ": more than " + std::to_string(most >> 20) +
                                          " MiB came through the pipe; save it in a file and give its name");
      if (size == room) {
        auto larger = std::make_unique_for_overwrite<char[]>(2 * room);
        std::memcpy(larger.get(), read_.get(), size);
        read_ = std::move(larger);
        room *= 2;
      }
      const auto got = ::read(descriptor, read_.get() + size, std::min({room - size, longest - size, kMostAtOnce}));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail("", cannot_read(errno));
      if (got == 0) break;
      size += static_cast<std::size_t>(got);
    }
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, path_.string() + ": not enough memory to read it; provide more memory");
  }
  bytes_ = {read_.get(), size};
}

void FileView::fail(const std::string& where, const std::string& message) const {
  std::string text = path_.string() + (where.empty() ? "" : ":" + where) + ": " + message;
  // Both may hold words of the file, and a zero byte would end the message.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  throw Error(ErrorCode::input, text,
              {.file = path_.string(), .line = number_after("line ", where), .byte = number_after("byte ", where)});
}

void FileView::fail_short(std::uint64_t offset, std::uint64_t bytes, const char* what) const {
  fail("byte " + std::to_string(offset), std::string(what) + " of " + std::to_string(bytes) +
                                             " bytes reaches past the end of the file, " + std::to_string(size()) +
                                             " bytes; it is cut off or damaged, get all of it");
}

std::string shown(std::string_view text, std::size_t longest) {
  std::string shown;
  for (const char c : text.substr(0, longest)) shown += c >= 0x20 && c < 0x7f ? c : '?';
  return text.size() > longest ? shown + "..." : shown;
}

std::string in_quotes(std::string_view text) {
  std::string quoted = "'";
  quoted += shown(text);
  return quoted += '\'';
}

}  // namespace standoff
