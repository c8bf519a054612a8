// SPDX-License-Identifier: Apache-2.0
#include "files/temp_file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "files/descriptor.h"
#include "files/temp_file_registry.h"
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

}  // namespace standoff
