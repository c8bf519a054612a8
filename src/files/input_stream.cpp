// SPDX-License-Identifier: Apache-2.0
#include "files/input_stream.h"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "files/open_pipe.h"
#include "standoff/error.h"

namespace standoff {

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

}  // namespace standoff
