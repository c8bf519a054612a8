// SPDX-License-Identifier: Apache-2.0
#include "files/spool_file.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "standoff/error.h"

namespace standoff {
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
