// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/companion_file.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <string_view>
#include <system_error>

#include "files/file_view.h"
#include "files/text.h"

namespace standoff {
namespace {

constexpr std::string_view kData = "data:";

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

// The value of a hexadecimal digit, or -1.
constexpr int hexadecimal(char c) {
  if (is_digit(c)) return c - '0';
  const char lower = static_cast<char>(c | 0x20);
  return lower >= 'a' && lower <= 'f' ? lower - 'a' + 10 : -1;
}

constexpr std::int8_t kNoDigit = -1;
constexpr std::array<std::int8_t, 256> kBase64 = [] {
  std::array<std::int8_t, 256> digits{};
  digits.fill(kNoDigit);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t n = 0; n < kDigits.size(); ++n)
    digits[static_cast<unsigned char>(kDigits[n])] = static_cast<std::int8_t>(n);
  return digits;
}();

// The padding at the end may be missing; nothing else may.
std::optional<std::string> base64_decoded(std::string_view text) {
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  if (text.size() % 4 == 1) return {};
  std::string data;
  data.reserve(text.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int held = 0;
  for (const unsigned char c : text) {
    if (kBase64[c] == kNoDigit) return {};
    bits = bits << 6 | static_cast<std::uint32_t>(kBase64[c]);
    held += 6;
    if (held < 8) continue;
    held -= 8;
    data += static_cast<char>(bits >> held);
  }
  return data;
}

}  // namespace

bool has_scheme(std::string_view uri) {
  const auto end = std::ranges::find_if_not(
      uri, [](char c) { return is_letter(c) || is_digit(c) || c == '+' || c == '-' || c == '.'; });
  return !uri.empty() && is_letter(uri[0]) && end != uri.end() && *end == ':';
}

std::string percent_decoded(std::string_view uri) {
  std::string decoded;
  for (std::size_t at = 0; at < uri.size(); ++at) {
    const bool escape = uri[at] == '%' && uri.size() - at > 2;
    const int high = escape ? hexadecimal(uri[at + 1]) : -1, low = escape ? hexadecimal(uri[at + 2]) : -1;
    if (high < 0 || low < 0) {
      decoded += uri[at];
      continue;
    }
    decoded += static_cast<char>(16 * high + low);
    at += 2;
  }
  return decoded;
}

bool is_data_uri(std::string_view uri) { return equals_ignoring_case(uri.substr(0, kData.size()), kData); }

std::optional<std::string> data_of_uri(std::string_view uri) {
  constexpr std::string_view kBase64Mark = ";base64";
  const auto comma = uri.find(',');
  if (!is_data_uri(uri) || comma == uri.npos) return {};
  const std::string_view head = uri.substr(0, comma), data = uri.substr(comma + 1);
  const std::string_view last = head.substr(head.size() - std::min(head.size(), kBase64Mark.size()));
  if (equals_ignoring_case(last, kBase64Mark)) return base64_decoded(data);
  return percent_decoded(data);
}

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
