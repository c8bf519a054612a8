// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/companion_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <string_view>
#include <system_error>

#include "files/descriptor.h"
#include "files/text_cursor.h"
#include "io/mesh/uri.h"

namespace standoff {
namespace {

constexpr const char* kPutBeside = "; put the file beside the mesh and name it there";

std::string said(int error) {
  if (error == ENOENT) return "no such file; put it beside the mesh";
  if (error == EACCES || error == EPERM) return "permission denied; make the file readable";
  return "cannot read it: " + std::generic_category().message(error) + "; check the disk and try again";
}

// Goes down from the mesh's folder, one part of the path at a time.
class CompanionSearch {
 public:
  CompanionSearch(const FileView& file, const std::string& where, const std::string& path)
      : file_(file), where_(where), path_(path) {}

  Descriptor open() {
    const std::filesystem::path parent = file_.path().parent_path();
    Descriptor folder(::open(parent.empty() ? "." : parent.c_str(), O_PATH | O_DIRECTORY | O_CLOEXEC));
    if (folder.number() < 0) fail(said(errno));
    std::string_view rest = path_;
    for (auto slash = rest.find('/'); slash != rest.npos; slash = rest.find('/')) {
      const std::string part(rest.substr(0, slash));
      rest.remove_prefix(slash + 1);
      require(S_IFDIR, about(folder, part));
      folder = Descriptor(::openat(folder.number(), part.c_str(), O_PATH | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC));
      if (folder.number() < 0) fail(said(errno));
    }
    return open_last(folder, std::string(rest));
  }

  [[noreturn]] void fail(const std::string& what) const { file_.fail(where_, in_quotes(path_) + ": " + what); }

 private:
  struct stat about(const Descriptor& folder, const std::string& name) const {
    struct stat found {};
    if (::fstatat(folder.number(), name.c_str(), &found, AT_SYMLINK_NOFOLLOW) != 0) fail(said(errno));
    return found;
  }

  void require(mode_t kind, const struct stat& about) const {
    const mode_t found = about.st_mode & S_IFMT;
    if (found == S_IFLNK) fail("a symbolic link is not followed; put the file itself there");
    if (found == kind) return;
    if (kind == S_IFDIR) fail("no such file; put it beside the mesh");
    fail(std::string(found == S_IFDIR ? "it is a folder" : "it is a pipe or a device") + "; name a regular file");
  }

  // To open a device can do things already: look first. Between the look and the opening it may have been exchanged, so
  // opening does not block, and what was opened is looked at again.
  Descriptor open_last(const Descriptor& folder, const std::string& name) const {
    require(S_IFREG, about(folder, name));
    Descriptor opened(
        ::openat(folder.number(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC));
    struct stat found {};
    if (opened.number() < 0 || ::fstat(opened.number(), &found) != 0) fail(said(errno));
    require(S_IFREG, found);
    return opened;
  }

  const FileView& file_;
  const std::string &where_, &path_;
};

}  // namespace

std::string companion_path(const FileView& file, const std::string& where, const std::string& uri) {
  const auto fail = [&](const std::string& what) { file.fail(where, in_quotes(uri) + " " + what + kPutBeside); };
  if (has_scheme(uri)) fail("is an address, and only files in the mesh's folder are read");
  const std::string decoded = percent_decoded(uri);
  if (std::ranges::any_of(decoded, [](unsigned char c) { return c < 0x20 || c == 0x7f; }))
    fail("holds a control character");
  if (decoded.find('\\') != decoded.npos) fail("holds a backslash; parts of a path are joined by /");
  if (decoded.starts_with('/')) fail("is an absolute path, and only files in the mesh's folder are read");
  std::string path;
  for (std::size_t at = 0; at <= decoded.size();) {
    const std::size_t end = std::min(decoded.find('/', at), decoded.size());
    const std::string_view part = std::string_view(decoded).substr(at, end - at);
    if (part == "..") fail("leaves the mesh's folder, and only files in it are read");
    if (!part.empty() && part != ".") path.append(path.empty() ? "" : "/").append(part);
    at = end + 1;
  }
  if (path.empty()) fail("names no file");
  return path;
}

std::unique_ptr<FileView> open_companion(const FileView& file, const std::string& where, const std::string& path,
                                         std::uint64_t longest) {
  return std::make_unique<FileView>(file.path().parent_path() / path, CompanionSearch(file, where, path).open(),
                                    longest);
}

}  // namespace standoff
