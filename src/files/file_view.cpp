// SPDX-License-Identifier: Apache-2.0
#include "files/file_view.h"

#include <fcntl.h>
#include <poll.h>
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
#include <system_error>

#include "core/progress.h"
#include "standoff/error.h"

namespace standoff {
namespace {

void (*notice)(const std::string&) = nullptr;

constexpr int kStepMs = 50, kStepsToNotice = 1000 / kStepMs;

void wait_a_step(pollfd* event) { ::poll(event, event ? 1 : 0, kStepMs); }

void tell(const std::filesystem::path& path, const char* what) {
  if (notice) notice(path.string() + ": " + what);
}

bool is_pipe(int file) {
  struct stat about {};
  return file >= 0 && ::fstat(file, &about) == 0 && S_ISFIFO(about.st_mode);
}

// From here on calls wait as usual.
void make_blocking(int file) { (void)!::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK); }

}  // namespace

void set_pipe_notice(void (*wanted)(const std::string&)) noexcept { notice = wanted; }

Descriptor open_to_read(const std::filesystem::path& path, ProgressMeter* waiting) {
  // A call that waits for a writer by itself would tell nobody, and on some threads nothing could stop it.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.number() < 0) return file;
  if (is_pipe(file.number()))
    for (int steps = 1;; ++steps) {
      pollfd data{file.number(), POLLIN, 0};
      wait_a_step(&data);
      if (data.revents != 0) break;
      if (waiting) waiting->check();
      if (steps == kStepsToNotice)
        tell(path, "nothing has come through this pipe for a second; waiting for a program to write to it");
    }
  make_blocking(file.number());
  return file;
}

Descriptor open_to_write(const std::filesystem::path& path, const std::filesystem::path& shown) {
  for (int steps = 1;; ++steps) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.number() >= 0) {
      make_blocking(file.number());
      return file;
    }
    if (errno != ENXIO) return file;
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0 || !S_ISFIFO(about.st_mode)) {
      errno = ENXIO;
      return file;
    }
    wait_a_step(nullptr);
    if (steps == kStepsToNotice)
      tell(shown, "nobody has opened this pipe for a second; waiting for a program to read it");
  }
}

std::string cannot_read(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "no such file; check the name";
    case EACCES:
    case EPERM:
      return "permission denied; choose a file that you may read";
    case EISDIR:
      return "it is a folder; give the name of a file";
    default:
      return "cannot read it: " + std::generic_category().message(error) + "; check the disk and try again";
  }
}

InputStream::InputStream(const std::string& name) : name_(name == "-" ? "standard input" : name) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorCode::input, name_ + ": " + what, {.file = name_});
  };
  if (name == "-") {
    file_ = STDIN_FILENO;
  } else {
    opened_ = open_to_read(name);
    file_ = opened_.number();
  }
  struct stat about {};
  if (file_ < 0 || ::fstat(file_, &about) != 0) fail(cannot_read(errno));
  if (S_ISDIR(about.st_mode)) fail(cannot_read(EISDIR));
  if (S_ISREG(about.st_mode)) size_ = static_cast<std::uint64_t>(about.st_size);
}

std::size_t InputStream::read(char* to, std::size_t room) {
  std::size_t got = 0;
  if (file_ < 0) {
    got = std::min(room, bytes_.size());
    if (got > 0) std::memcpy(to, bytes_.data(), got);
    bytes_.remove_prefix(got);
  } else {
    constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
    ssize_t count = 0;
    do count = ::read(file_, to, std::min(room, kMostAtOnce));
    while (count < 0 && errno == EINTR);
    if (count < 0) throw Error(ErrorCode::input, name_ + ": " + cannot_read(errno), {.file = name_});
    got = static_cast<std::size_t>(count);
  }
  done_ += got;
  return got;
}

namespace {

constexpr std::string_view kMark = "\xEF\xBB\xBF";

}  // namespace

bool LineReader::next(std::string_view& line) {
  if (!begun_) begin();
  while (next_raw(line)) {
    line = line.substr(0, line.find('#'));
    line = line.substr(0, line.find_last_not_of(" \t\r\v\f") + 1);
    if (!line.empty()) return true;
  }
  return false;
}

void LineReader::begin() {
  begun_ = true;
  buffer_.resize(kLongestLine + 1);
  while (end_ < buffer_.size() && refill()) {
  }
  const std::string_view start(buffer_.data(), end_);
  if (start.starts_with(kMark)) at_ = kMark.size();
  if (start.find('\n') == std::string_view::npos && start.find('\r') != std::string_view::npos) line_end_ = '\r';
}

// Moves what is left to the front, and reads more after it.
bool LineReader::refill() {
  if (ended_) return false;
  std::memmove(buffer_.data(), buffer_.data() + at_, end_ - at_);
  end_ -= at_;
  at_ = 0;
  const std::size_t got = input_.read(buffer_.data() + end_, buffer_.size() - end_);
  end_ += got;
  ended_ = got == 0;
  return got > 0;
}

bool LineReader::next_raw(std::string_view& line) {
  for (std::size_t looked = 0;;) {
    const char* begin = buffer_.data() + at_;
    const void* stop = std::memchr(begin + looked, line_end_, end_ - at_ - looked);
    if (stop) {
      line = {begin, static_cast<std::size_t>(static_cast<const char*>(stop) - begin)};
      at_ += line.size() + 1;
      ++number_;
      return true;
    }
    looked = end_ - at_;
    if (looked > kLongestLine) {
      ++number_;
      fail("a line of more than " + std::to_string(kLongestLine) + " bytes; it is no table of points, check the file");
    }
    if (refill()) continue;
    if (looked == 0) return false;
    line = {buffer_.data() + at_, looked};
    at_ = end_;
    ++number_;
    return true;
  }
}

void LineReader::fail_at(std::uint64_t number, const std::string& message) const {
  throw Error(ErrorCode::input, name() + ":line " + std::to_string(number) + ": " + message,
              {.file = name(), .line = static_cast<std::int64_t>(number)});
}

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

void FileView::check() const {
  if (waiting_) waiting_->check();
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
