#include "io/file_view.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "difi/error.h"

namespace difi {
namespace {

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) ::close(number);
  }
};

std::string reason(int error) {
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

}  // namespace

FileView::FileView(const std::filesystem::path& path) : path_(path) {
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  struct stat about {};
  if (file.number < 0 || ::fstat(file.number, &about) != 0) fail("", reason(errno));
  if (S_ISDIR(about.st_mode)) fail("", reason(EISDIR));
  if (S_ISFIFO(about.st_mode)) {
    read_all(file.number);
    return;
  }
  if (!S_ISREG(about.st_mode)) fail("", "it is a device; give the name of a file");
  if (about.st_size == 0) return;
  const auto size = static_cast<std::size_t>(about.st_size);
  void* mapped = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number, 0);
  if (mapped == MAP_FAILED) fail("", reason(errno));
  mapped_ = mapped;
  bytes_ = {static_cast<const char*>(mapped), size};
}

FileView::~FileView() {
  if (mapped_) ::munmap(mapped_, bytes_.size());
}

void FileView::read_all(int descriptor) {
  constexpr std::size_t kStep = std::size_t{1} << 20;
  for (;;) {
    const std::size_t before = read_.size();
    read_.resize(before + kStep);
    const auto got = ::read(descriptor, read_.data() + before, kStep);
    read_.resize(before + static_cast<std::size_t>(got > 0 ? got : 0));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("", reason(errno));
    if (got == 0) break;
  }
  bytes_ = read_;
}

void FileView::fail(const std::string& where, const std::string& message) const {
  throw Error(ErrorCode::input, path_.string() + (where.empty() ? "" : ":" + where) + ": " + message);
}

}  // namespace difi
