// Files of other programs' making, or for them.
#include <new>

#include "difi/io.h"
#include "io/atomic_file.h"
#include "io/file_view.h"

namespace difi {

std::string read_text(const std::filesystem::path& path) {
  try {
    return std::string(FileView(path).bytes());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::limit, path.string() + ": not enough memory for it; use a machine with more");
  }
}

void write_text(const std::filesystem::path& path, std::string_view text, Existing existing) {
  AtomicFile file(path, existing);
  file.write(text.data(), text.size());
  file.commit();
}

}  // namespace difi
