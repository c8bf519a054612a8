// SPDX-License-Identifier: Apache-2.0
#ifdef STANDOFF_HAVE_PNG
#include <png.h>
#endif

#include <string>

#include "files/atomic_file.h"
#include "render/image.h"
#include "standoff/error.h"

namespace standoff {

#ifdef STANDOFF_HAVE_PNG

void require_png() {}

std::vector<std::uint8_t> png_of(const Image& image) {
  // libpng's simplified interface reports errors without longjmp, which must not skip destructors.
  png_image header{};
  header.version = PNG_IMAGE_VERSION;
  header.width = static_cast<png_uint_32>(image.width);
  header.height = static_cast<png_uint_32>(image.height);
  header.format = PNG_FORMAT_RGB;
  header.flags = PNG_IMAGE_FLAG_FAST;  // a third of the time; files of pictures are about as large
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(header);
  std::vector<std::uint8_t> encoded(bytes);
  if (!png_image_write_to_memory(&header, encoded.data(), &bytes, 0, image.pixels.data(), 0, nullptr))
    throw Error(ErrorCode::internal,
                std::string("libpng cannot encode the picture: ") + header.message + "; please report this");
  encoded.resize(bytes);
  return encoded;
}

#else

void require_png() {
  throw Error(
      ErrorCode::usage,
      "pictures need libpng, which this build of standoff lacks; install it (Debian: libpng-dev) and build again");
}

std::vector<std::uint8_t> png_of(const Image&) {
  require_png();
  return {};
}

#endif

void write_png(const std::filesystem::path& path, const Image& image, Existing existing) {
  AtomicFile file(path, existing);
  const std::vector<std::uint8_t> bytes = png_of(image);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

}  // namespace standoff
