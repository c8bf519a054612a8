// SPDX-License-Identifier: Apache-2.0
// Any bytes, as each format of points: an error or as many points as the reader promises, all of them valid or marked.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "io/points/points.h"
#include "standoff/error.h"

namespace {

using namespace standoff;

using Open = std::unique_ptr<PointReader> (*)(std::string_view, InvalidPoints);
template <std::unique_ptr<PointReader> (*open)(std::unique_ptr<FileView>, InvalidPoints)>
std::unique_ptr<PointReader> binary(std::string_view bytes, InvalidPoints invalid) {
  return open(std::make_unique<FileView>("fuzz", bytes), invalid);
}
std::unique_ptr<PointReader> text(std::string_view bytes, InvalidPoints invalid) {
  return text_points(LineReader(InputStream("fuzz", bytes)), invalid);
}

void read_all(Open open, std::string_view bytes, InvalidPoints invalid) {
  try {
    const auto reader = open(bytes, invalid);
    std::array<Vec3, 100> points;
    std::uint64_t all = 0;
    for (std::size_t got = points.size(); got == points.size(); all += got) {
      got = reader->read(points);
      for (std::size_t n = 0; n < got; ++n) {
        const bool marked = std::isnan(points[n].x) && std::isnan(points[n].y) && std::isnan(points[n].z);
        if (!(max_norm(points[n]) <= kMaxCoordinate) && !(marked && invalid == InvalidPoints::mark)) std::abort();
      }
      if (!(reader->fraction() >= 0 && reader->fraction() <= 1)) std::abort();
    }
    if (reader->count() && *reader->count() != all) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  for (const InvalidPoints invalid : {InvalidPoints::reject, InvalidPoints::mark})
    for (const Open open : {Open{text}, Open{binary<ply_points>}, Open{binary<npy_points>}, Open{binary<npz_points>}})
      read_all(open, bytes, invalid);
  return 0;
}
