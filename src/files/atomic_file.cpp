// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <dirent.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "core/guarded.h"
#include "core/number_text.h"
#include "core/progress.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// Large enough that system calls cost nothing against copying, small enough to stay in the cache.
constexpr std::size_t kBuffer = std::size_t{1} << 18;
// Between calls of write the caller may stop.
constexpr std::size_t kMaxWrite = std::size_t{1} << 24;
constexpr int kOpen = O_WRONLY | O_CLOEXEC;
constexpr mode_t kMode = 0666;

std::string reason(int error, const std::filesystem::path& folder) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "no space left on the disk; free some or write to another one";
    case EFBIG:
      return "the file is larger than allowed here; raise the limit (ulimit -f) or write to another file system";
    case EACCES:
    case EPERM:
      return "permission denied; choose a file and folder that you may write";
    case EROFS:
      return "the file system is read-only; write to another folder";
    case ENOENT:
      if (std::error_code ignored; std::filesystem::is_directory(folder, ignored))  // as /proc and /sys say it
        return "the folder " + folder.string() + " takes no new files; choose another place";
      return "the folder " + folder.string() + " does not exist; create it first";
    case ENOTDIR:
      return folder.string() + " is not a folder; choose another place";
    case EISDIR:
      return "it is a folder; give the name of a file";
    case EEXIST:
      return "somebody has written it, and it stays as it is; give another name, or let it be replaced";
    case ENAMETOOLONG:
      return "the name is too long; choose a shorter one";
    case ESPIPE:
      return "this format needs a file that can be rewritten, not a pipe; write to a file";
    default:
      return std::generic_category().message(error) + "; check the disk and try again";
  }
}

}  // namespace

// The time tells apart processes that share a number in other namespaces.
std::string unfinished_name() {
  static std::atomic<unsigned> count{0};
  const auto now = static_cast<unsigned long long>(std::chrono::system_clock::now().time_since_epoch().count());
  std::array<char, 64> name{};
  std::snprintf(name.data(), name.size(), ".standoff-%llx-%x-%x.part", now, static_cast<unsigned>(::getpid()), count++);
  return name.data();
}

void fail_to_write(const std::filesystem::path& shown, int error, const std::filesystem::path& folder) {
  throw Error(ErrorCode::output, shown.string() + ": cannot write it: " + reason(error, folder),
              {.file = shown.string()});
}

std::filesystem::path end_of_links(std::filesystem::path path) {
  constexpr int kMostLinks = 40;  // as many as Linux follows
  std::error_code no_link;
  for (int n = 0; n < kMostLinks; ++n) {
    const auto next = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = path.parent_path() / next;  // an absolute one replaces the folder
  }
  return path;
}

namespace {

std::string handle_of(int file) { return "/proc/self/fd/" + std::to_string(file); }

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target, Existing existing, Unfinished unfinished)
    : shown_(target), existing_(existing) {
  std::error_code ignored;
  if (target.empty()) throw Error(ErrorCode::output, "cannot write a file without a name; give one");
  if (!target.has_filename()) fail(EISDIR);
  target_ = std::filesystem::absolute(end_of_links(target), ignored);

  struct stat there {};
  const bool exists = ::stat(target_.c_str(), &there) == 0;
  if (!exists && errno != ENOENT) fail(errno);
  if (exists && S_ISDIR(there.st_mode)) fail(EISDIR);
  // A file that its owner has made read-only stays, although renaming over it would work.
  if (exists && ::access(target_.c_str(), W_OK) != 0) fail(errno);
  if (exists && !S_ISREG(there.st_mode)) {
    kind_ = Kind::straight;
    file_ = open_to_write(target_, shown_).release();
    if (file_ < 0) fail(errno);
    return;
  }
  if (exists && existing_ == Existing::keep) fail(EEXIST);
  folder_ = target_.parent_path();
  if (unfinished == Unfinished::named || !open_unnamed()) open_named();
  if (exists) (void)!::fchmod(file_, there.st_mode & 0777);
}

bool AtomicFile::open_unnamed() {
#ifdef O_TMPFILE
  file_ = ::open(folder_.c_str(), kOpen | O_TMPFILE, kMode);
  if (file_ < 0) return false;
  // Naming it later goes through /proc, which a container may lack.
  if (::access(handle_of(file_).c_str(), F_OK) == 0) {
    kind_ = Kind::unnamed;
    return true;
  }
  ::close(file_);
#endif
  return false;
}

void AtomicFile::open_named() {
  unfinished_ = folder_ / unfinished_name();
  slot_ = note_unfinished(unfinished_);
  file_ = ::open(unfinished_.c_str(), kOpen | O_CREAT | O_EXCL, kMode);
  if (file_ >= 0) return;
  const int error = errno;
  forget_unfinished(slot_);
  fail(error);
}

AtomicFile::~AtomicFile() { discard(); }

void AtomicFile::check() const {
  if (waiting_) waiting_->check();
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  if (bytes == 0) return;
  if (!buffer_) buffer_ = std::make_unique_for_overwrite<char[]>(kBuffer);
  size_ += bytes;
  if (bytes > kBuffer - buffered_) flush();
  if (bytes >= kBuffer) return append(static_cast<const char*>(data), bytes);
  std::memcpy(buffer_.get() + buffered_, data, bytes);
  buffered_ += bytes;
}

void AtomicFile::overwrite(std::uint64_t offset, const void* data, std::size_t bytes) {
  flush();
  const auto* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const auto done = ::pwrite(file_, from, bytes, static_cast<off_t>(offset));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(done < 0 ? errno : EIO);
    from += done;
    offset += static_cast<std::uint64_t>(done);
    bytes -= static_cast<std::size_t>(done);
  }
}

void AtomicFile::flush() {
  append(buffer_.get(), buffered_);
  buffered_ = 0;
}

void AtomicFile::append(const char* data, std::size_t bytes) {
  if (kind_ == Kind::straight && bytes > 0 && !std::exchange(noted_straight_, true)) note_straight(1);
  while (bytes > 0) {
    check();
    const auto done = ::write(file_, data, std::min(bytes, kMaxWrite));
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(done < 0 ? errno : EIO);
    data += done;
    bytes -= static_cast<std::size_t>(done);
  }
}

void AtomicFile::commit() {
  flush();
  if (kind_ != Kind::straight) {
    if (waits_for_disk_)
      sync(file_);
    else
      begin_to_sync(file_);
    note_finishing(shown_, file_);
  }
  if (kind_ == Kind::unnamed) link_unnamed();
  close();
  if (kind_ == Kind::straight) {
    if (std::exchange(noted_straight_, false)) note_straight(-1);
    return;
  }
  if (unfinished_ != target_) take_name();
  if (waits_for_disk_) sync_folder();
  unfinished_.clear();
  forget_unfinished(slot_);
  slot_ = -1;
}

// Without it a disk may have the name before the bytes, and after a loss of power the name alone.
void AtomicFile::sync(int file) const {
  while (::fsync(file) != 0) {
    if (errno == EINTR) continue;
    if (errno == EINVAL || errno == ENOSYS || errno == ENOTSUP) return;  // there are file systems that cannot
    fail(errno);
  }
}

// Lets the disk work while the next file is made: else all that thousands of files have is written while their program
// waits at its end. It decides time only.
void AtomicFile::begin_to_sync([[maybe_unused]] int file) noexcept {
#ifdef SYNC_FILE_RANGE_WRITE
  (void)!::sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE);
#endif
}

// The name is an entry of the folder. Whatever goes wrong here, the file is there and whole.
void AtomicFile::sync_folder() const noexcept {
  const Descriptor folder(::open(folder_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.number() >= 0) (void)::fsync(folder.number());
}

// Gives the unnamed file the target's name, or, when that is taken, a name to rename from: linking cannot replace.
void AtomicFile::link_unnamed() {
  const std::string handle = handle_of(file_);
  const auto link_as = [&](const std::filesystem::path& name) {
    return ::linkat(AT_FDCWD, handle.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  };
  if (link_as(target_)) {
    unfinished_ = target_;  // until it is closed without an error
    return;
  }
  if (errno != EEXIST || existing_ == Existing::keep) fail(errno);
  unfinished_ = folder_ / unfinished_name();
  slot_ = note_unfinished(unfinished_);
  if (!link_as(unfinished_)) fail(errno);
}

// From the unfinished file's name to the target's.
void AtomicFile::take_name() {
  const char *const from = unfinished_.c_str(), *const to = target_.c_str();
  if (existing_ == Existing::keep) {
    // A link replaces nothing, and a rename only where it may. There are file systems that lack either (FAT knows no
    // links, NFS no such renames) and a few that lack both: there the look comes a moment before the rename.
    if (::link(from, to) == 0) {
      ::unlink(from);
      return;
    }
    if (errno == EEXIST) fail(EEXIST);
#ifdef RENAME_NOREPLACE
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return;
    if (errno == EEXIST) fail(EEXIST);
#endif
    if (::access(to, F_OK) == 0) fail(EEXIST);
  }
  if (::rename(from, to) != 0) fail(errno);
}

void AtomicFile::close() {
  const int file = file_;
  file_ = -1;
  // Network file systems tell of a full disk only here. After EINTR the state is unspecified; Linux has closed it.
  if (file >= 0 && ::close(file) != 0 && errno != EINTR) fail(errno);
}

void AtomicFile::discard() noexcept {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  if (!unfinished_.empty()) ::unlink(unfinished_.c_str());
  forget_unfinished(slot_);
  slot_ = -1;
}

void AtomicFile::fail(int error) const { fail_to_write(shown_, error, target_.parent_path()); }

std::optional<std::uint64_t> room_for(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::path target = std::filesystem::absolute(end_of_links(file), error);
  if (error) return std::nullopt;
  const std::filesystem::file_status there = std::filesystem::status(target, error);
  if (std::filesystem::exists(there) && !std::filesystem::is_regular_file(there) &&
      !std::filesystem::is_directory(there))
    return std::nullopt;
  const std::filesystem::space_info space = std::filesystem::space(target.parent_path(), error);
  // There are file systems of networks and of memory that say 0 and take files.
  if (error || space.available == 0 || space.available == static_cast<std::uintmax_t>(-1)) return std::nullopt;
  return space.available;
}

void expect_room(const std::filesystem::path& file, double bytes, std::optional<std::uint64_t> room) {
  constexpr double kMiB = 1 << 20;
  if (!room || bytes <= static_cast<double>(*room)) return;
  throw Error(ErrorCode::output,
              file.string() + ": cannot write it: it takes " + whole_text(std::ceil(bytes / kMiB)) +
                  " MiB, and its disk has " + whole_text(std::floor(static_cast<double>(*room) / kMiB)) +
                  " MiB free; free some, write to another one, or take fewer samples",
              {.file = file.string()});
}

std::string read_text(const std::filesystem::path& path) try {
  try {
    return std::string(FileView(path).bytes());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, path.string() + ": not enough memory for it; provide more memory");
  }
} catch (...) {
  throw_as_error("file");
}

void write_text(const std::filesystem::path& path, std::string_view text, Existing existing) try {
  AtomicFile file(path, existing);
  file.write(text.data(), text.size());
  file.commit();
} catch (...) {
  throw_as_error("file");
}

TempFile::TempFile(std::string_view suffix, std::string_view bytes) {
  const auto fail = [this] {
    const std::string why = std::strerror(errno);
    remove();
    throw Error(ErrorCode::output, path_.string() + ": " + why + "; make room there, or set TMPDIR to another folder");
  };
  std::error_code ignored;
  std::string name = (std::filesystem::temp_directory_path(ignored) / "standoff-XXXXXX").string();
  name += suffix;
  path_ = name;
  const Descriptor file(::mkstemps(name.data(), static_cast<int>(suffix.size())));
  if (file.number() < 0) fail();
  path_ = name;
  slot_ = note_unfinished(path_);
  while (!bytes.empty()) {
    const auto written = ::write(file.number(), bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail();
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

TempFile::~TempFile() { remove(); }

void TempFile::remove() noexcept {
  ::unlink(path_.c_str());
  forget_unfinished(slot_);
  slot_ = -1;
}

namespace {

// A handler may neither allocate nor lock: fixed slots, each published by one atomic store after its name is complete.
enum State : int { kFree, kFilling, kNoted };

struct Slot {
  std::atomic<int> state{kFree};
  std::array<char, 4096> name{};
};
static_assert(std::atomic<int>::is_always_lock_free);

// More files than one process writes at a time.
std::array<Slot, 32> slots;

// The file that was finished last.
struct Finishing : Slot {
  dev_t device = 0;
  ino_t number = 0;
} finishing;

std::atomic<int> straight{0};

// Removes what is in an open folder, and in the folders in it; closes it. What readdir does by the heap is done by
// system calls. Each folder within another takes 4 KiB of the stack.
void empty_folder(int folder, int deepest) noexcept {
#ifdef SYS_getdents64
  alignas(8) char entries[4096];
  constexpr long kLength = 16, kType = 18, kName = 19;  // of struct linux_dirent64
  for (long got; (got = ::syscall(SYS_getdents64, folder, entries, sizeof entries)) > 0;)
    for (long at = 0; at < got;) {
      const char* const name = entries + at + kName;
      const bool itself = std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0;
      if (!itself && entries[at + kType] == DT_DIR && deepest > 0) {
        const int inner = ::openat(folder, name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
        if (inner >= 0) empty_folder(inner, deepest - 1);
        ::unlinkat(folder, name, AT_REMOVEDIR);
      } else if (!itself) {
        ::unlinkat(folder, name, 0);
      }
      std::uint16_t length;
      std::memcpy(&length, entries + at + kLength, sizeof length);
      at += length;
    }
#endif
  ::close(folder);
}

}  // namespace

void remove_folder(const char* name) noexcept {
  constexpr int kDeepest = 32;
  const int folder = ::open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (folder >= 0) empty_folder(folder, kDeepest);
  ::rmdir(name);
}

int note_unfinished(const std::filesystem::path& path) noexcept {
  const auto& name = path.native();
  if (name.size() >= slots[0].name.size()) return -1;
  for (std::size_t s = 0; s < slots.size(); ++s) {
    int expected = kFree;
    if (!slots[s].state.compare_exchange_strong(expected, kFilling)) continue;
    std::memcpy(slots[s].name.data(), name.c_str(), name.size() + 1);
    slots[s].state = kNoted;
    return static_cast<int>(s);
  }
  return -1;
}

void forget_unfinished(int slot) noexcept {
  if (slot >= 0) slots[static_cast<std::size_t>(slot)].state = kFree;
}

void remove_unfinished_files() noexcept {
  for (Slot& slot : slots)
    if (slot.state == kNoted && ::unlink(slot.name.data()) != 0 && errno != ENOENT) remove_folder(slot.name.data());
}

void note_finishing(const std::filesystem::path& target, int file) noexcept {
  const auto& name = target.native();
  struct stat about {};
  // Of two that end at once, one will do.
  int before = finishing.state;
  if (name.size() >= finishing.name.size() || ::fstat(file, &about) != 0 || before == kFilling ||
      !finishing.state.compare_exchange_strong(before, kFilling))
    return;
  std::memcpy(finishing.name.data(), name.c_str(), name.size() + 1);
  finishing.device = about.st_dev;
  finishing.number = about.st_ino;
  finishing.state = kNoted;
}

void forget_finished() noexcept {
  int before = kNoted;
  finishing.state.compare_exchange_strong(before, kFree);
}

void note_straight(int more) noexcept { straight += more; }
bool is_writing_straight() noexcept { return straight > 0; }

const char* finished_file() noexcept {
  struct stat about {};
  const bool is_there = finishing.state == kNoted && ::stat(finishing.name.data(), &about) == 0 &&
                        about.st_dev == finishing.device && about.st_ino == finishing.number;
  return is_there ? finishing.name.data() : nullptr;
}

namespace {

constexpr std::size_t kSpoolBuffer = std::size_t{1} << 20;

}  // namespace

SpoolFile::SpoolFile(const std::filesystem::path& folder, const std::filesystem::path& shown) : shown_(shown) {
  const std::string place = folder.empty() ? "." : folder.string();
#ifdef O_TMPFILE
  file_ = Descriptor(::open(place.c_str(), O_RDWR | O_CLOEXEC | O_TMPFILE, 0600));
#endif
  if (file_.number() >= 0) return;
  // Without unnamed files it has a name for a moment.
  std::string name = place + "/.standoff-XXXXXX";
  file_ = Descriptor(::mkostemp(name.data(), O_CLOEXEC));
  if (file_.number() < 0) fail(errno);
  ::unlink(name.c_str());
}

void SpoolFile::write(const void* data, std::size_t bytes) {
  const auto* from = static_cast<const std::byte*>(data);
  buffer_.insert(buffer_.end(), from, from + bytes);
  size_ += bytes;
  if (buffer_.size() >= kSpoolBuffer) flush();
}

void SpoolFile::flush() {
  for (std::size_t at = 0; at < buffer_.size();) {
    const auto done = ::write(file_.number(), buffer_.data() + at, buffer_.size() - at);
    if (done < 0 && errno == EINTR) continue;
    if (done <= 0) fail(done < 0 ? errno : EIO);
    at += static_cast<std::size_t>(done);
  }
  buffer_.clear();
}

std::span<const std::byte> SpoolFile::part_at(std::uint64_t offset) {
  buffer_.resize(kSpoolBuffer);
  for (;;) {
    const auto got = ::pread(file_.number(), buffer_.data(), buffer_.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) fail(got < 0 ? errno : EIO);
    return {buffer_.data(), static_cast<std::size_t>(got)};
  }
}

void SpoolFile::fail(int error) const {
  throw Error(ErrorCode::output,
              shown_.string() + ": cannot write it: " +
                  (error == ENOSPC || error == EDQUOT
                       ? "no space left on the disk for the bytes beside it; free some or write to another one"
                       : std::generic_category().message(error) + "; check the disk and try again"),
              {.file = shown_.string()});
}

}  // namespace standoff
