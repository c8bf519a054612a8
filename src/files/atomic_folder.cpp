// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_folder.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>

#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// "a/b/" means the folder "a/b".
std::filesystem::path without_slash(const std::filesystem::path& path) {
  return path.has_filename() ? path : path.parent_path();
}

// Renames, if the system knows how to in this way: RENAME_NOREPLACE or RENAME_EXCHANGE. Else errno is EINVAL.
bool rename_as(const std::filesystem::path& from, const std::filesystem::path& to, [[maybe_unused]] unsigned how) {
#ifdef RENAME_NOREPLACE
  return ::renameat2(AT_FDCWD, from.c_str(), AT_FDCWD, to.c_str(), how) == 0;
#else
  errno = EINVAL;
  return false;
#endif
}
#ifdef RENAME_NOREPLACE
constexpr unsigned kNoReplace = RENAME_NOREPLACE, kExchange = RENAME_EXCHANGE;
#else
constexpr unsigned kNoReplace = 0, kExchange = 0;
#endif

bool is_empty_folder(const std::filesystem::path& folder) {
  return all_entries(folder, [](const char*, bool) { return false; });
}

bool is_unknown_rename(int error) { return error == EINVAL || error == ENOSYS || error == ENOTSUP; }

}  // namespace

bool all_entries(const std::filesystem::path& folder,
                 const std::function<bool(const char* name, bool is_folder)>& holds) {
  const std::unique_ptr<DIR, int (*)(DIR*)> opened(::opendir(folder.c_str()), ::closedir);
  if (!opened) return false;
  while (const dirent* const entry = ::readdir(opened.get())) {
    const char* const name = entry->d_name;
    if (std::strcmp(name, ".") == 0 || std::strcmp(name, "..") == 0) continue;
    struct stat found {};
    if (::fstatat(::dirfd(opened.get()), name, &found, AT_SYMLINK_NOFOLLOW) != 0) return false;
    if (!holds(name, S_ISDIR(found.st_mode))) return false;
  }
  return true;
}

AtomicFolder::AtomicFolder(const std::filesystem::path& target, Existing existing, MayReplace may_replace,
                           const char* kind)
    : shown_(target), existing_(existing), may_replace_(may_replace), kind_(kind) {
  if (target.empty()) throw Error(ErrorCode::output, "cannot write a folder without a name; give one");
  std::error_code ignored;
  target_ = std::filesystem::absolute(end_of_links(without_slash(target)), ignored);
  check_target();
  unfinished_ = target_.parent_path() / unfinished_name();
  slot_ = note_unfinished(unfinished_);
  if (::mkdir(unfinished_.c_str(), 0777) == 0) return;
  const int error = errno;
  forget_unfinished(slot_);
  fail(error);
}

AtomicFolder::~AtomicFolder() { discard(); }

void AtomicFolder::check_target() const {
  const auto refuse = [this](const std::string& what) {
    throw Error(ErrorCode::output, shown_.string() + ": cannot write it: " + what, {.file = shown_.string()});
  };
  struct stat there {};
  if (::stat(target_.c_str(), &there) != 0) {
    if (errno == ENOENT) return;
    fail(errno);
  }
  if (existing_ == Existing::keep) fail(EEXIST);
  if (!S_ISDIR(there.st_mode)) refuse("it is a file; give another name, or remove it");
  if (is_empty_folder(target_)) return;
  if (!may_replace_(target_))
    refuse(std::string("a folder is there that is not ") + kind_ + "; give another name, or remove it");
}

void AtomicFolder::commit() {
  sync();
  {
    const Descriptor folder(::open(unfinished_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    note_finishing(shown_, folder.number());
  }
  take_name();
  const Descriptor parent(::open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (parent.number() >= 0) (void)::fsync(parent.number());
  discard();  // what was in the target's place, if anything was
}

// Thousands of files: one wait for all of them.
void AtomicFolder::sync() const {
  const Descriptor folder(::open(unfinished_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (folder.number() < 0) fail(errno);
#ifdef __linux__
  if (::syncfs(folder.number()) != 0) fail(errno);
#endif
}

void AtomicFolder::take_name() {
  if (rename_as(unfinished_, target_, kNoReplace)) return;
  if (errno == EEXIST && existing_ == Existing::keep) fail(EEXIST);
  if (errno == EEXIST) return swap_with_target();
  if (!is_unknown_rename(errno)) fail(errno);
  // A look, and a moment later a rename, which replaces no folder but an empty one.
  if (existing_ == Existing::keep && ::access(target_.c_str(), F_OK) == 0) fail(EEXIST);
  if (::rename(unfinished_.c_str(), target_.c_str()) == 0) return;
  if (errno != ENOTEMPTY && errno != EEXIST) fail(errno);
  swap_with_target();
}

void AtomicFolder::swap_with_target() {
  check_target();  // it may be another one by now
  if (rename_as(unfinished_, target_, kExchange)) return;
  if (!is_unknown_rename(errno)) fail(errno);
  // For a moment nothing is there.
  const std::filesystem::path aside = target_.parent_path() / unfinished_name();
  if (::rename(target_.c_str(), aside.c_str()) != 0) fail(errno);
  if (::rename(unfinished_.c_str(), target_.c_str()) != 0) {
    const int error = errno;
    (void)!::rename(aside.c_str(), target_.c_str());
    fail(error);
  }
  unfinished_ = aside;
}

void AtomicFolder::discard() noexcept {
  if (!unfinished_.empty()) remove_folder(unfinished_.c_str());
  unfinished_.clear();
  forget_unfinished(slot_);
  slot_ = -1;
}

void AtomicFolder::fail(int error) const { fail_to_write(shown_, error, target_.parent_path()); }

}  // namespace standoff
