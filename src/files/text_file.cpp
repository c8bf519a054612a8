// SPDX-License-Identifier: Apache-2.0
#include "files/text_file.h"

#include <new>

#include "core/guarded.h"
#include "files/atomic_file.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff {

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

}  // namespace standoff
