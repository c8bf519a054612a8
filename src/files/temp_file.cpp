// SPDX-License-Identifier: Apache-2.0
#include "files/temp_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <system_error>

#include "files/descriptor.h"
#include "standoff/error.h"

namespace standoff {

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

// Of a folder that has no folders in it. What readdir does by the heap is done by system calls.
void remove_folder(const char* name) noexcept {
#ifdef SYS_getdents64
  const int folder = ::open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  alignas(8) char entries[4096];
  constexpr long kLength = 16, kName = 19;  // of struct linux_dirent64
  for (long got; (got = ::syscall(SYS_getdents64, folder, entries, sizeof entries)) > 0;)
    for (long at = 0; at < got;) {
      ::unlinkat(folder, entries + at + kName, 0);
      std::uint16_t length;
      std::memcpy(&length, entries + at + kLength, sizeof length);
      at += length;
    }
  ::close(folder);
#endif
  ::rmdir(name);
}

}  // namespace

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
