// SPDX-License-Identifier: Apache-2.0
// The fuzzer of Zarr stores: the bytes are an array's metadata, the index of a shard, a chunk that blosc unpacks, and
// changes to the files of a good store.
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/zarr/blosc.h"
#include "io/zarr/metadata.h"
#include "io/zarr/shard.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "standoff/zarr.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

void read_as_metadata(std::string_view bytes) {
  const FileView file("fuzz", bytes);
  try {
    const zarr::ArrayLayout layout = zarr::read_array(file);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (layout.chunk[axis] < 1 || layout.shard[axis] % layout.chunk[axis] != 0) std::abort();
    if (layout.chunk_bytes() > zarr::kMostChunkBytes || layout.chunks().count() > zarr::kMostChunks) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input) std::abort();
  }
}

void unpack(std::string_view bytes) {
  if (!zarr::have_blosc()) return;
  std::vector<std::byte> out(4096);
  static_cast<void>(zarr::blosc_unpack(bytes, out));
}

/// A store of one shard, kept from call to call, and its files.
struct GoodStore {
  GoodStore() {
    DistanceField field({{16, 9, 16}, {1, 2, 3}, {0.5, 1, 2}}, 1);
    const auto values = field.store_tile(1, 0, 0);
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n) / 256 - 1;
    field.mark_inside(0, 1, 1);
    ZarrStore::create(path, field.grid(), 1, {},
                      {.shard = {16, 16, 16}, .chunk = {8, 16, 8}, .compress = zarr::have_blosc()});
    // Without the checksums of metadata and chunks, which would refuse nearly all changes before anything else does.
    std::string array = read_bytes(files[1]);
    const std::string codec = R"(, {"name": "crc32c"})";
    array.erase(array.find(codec), codec.size());
    const std::size_t sum = array.find(R"(, "metadata_crc32c")");
    array.erase(sum, array.find('}', sum) - sum);
    write_bytes(files[1], array);
    ZarrStore::open(path).write({}, field);
    for (std::size_t n = 0; n < files.size(); ++n) good[n] = read_bytes(files[n]);
  }

  const TempFolder folder;
  const std::filesystem::path path = folder / "a.zarr";
  const std::array<std::filesystem::path, 3> files{path / "zarr.json", path / "0" / "zarr.json",
                                                   path / "0" / "c" / "0" / "0" / "0"};
  std::array<std::string, 3> good;
};

// Each four bytes of the fuzzer's change one of a file. Changes that hit an index get their checksum.
void read_changed(const std::uint8_t* data, std::size_t size) {
  static const GoodStore store;
  std::array<std::string, 3> files = store.good;
  for (std::size_t at = 0; at + 4 <= size; at += 4) {
    std::uint32_t change;
    std::memcpy(&change, data + at, sizeof change);
    std::string& file = files[(change >> 24) % 3];
    file[(change >> 8 & 0xffff) % file.size()] = static_cast<char>(change & 0xff);
  }
  constexpr std::size_t kIndex = 4 * 16;
  std::string& shard = files[2];
  const std::span index(shard.data() + shard.size() - kIndex - 4, kIndex);
  const std::uint32_t crc = zarr::crc32c(std::as_bytes(index));
  std::memcpy(shard.data() + shard.size() - 4, &crc, sizeof crc);
  for (std::size_t n = 0; n < files.size(); ++n) write_bytes(store.files[n], files[n]);
  try {
    const DistanceField field = read_field(store.path, {.memory_limit = std::int64_t{64} << 20});
    if (!(field.thickness() > 0)) std::abort();
    for (const float value : field.tile_values())
      if (!(std::abs(value) <= static_cast<float>(field.thickness()))) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit) std::abort();
  }
}

}  // namespace
}  // namespace standoff

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  standoff::read_as_metadata(bytes);
  standoff::unpack(bytes);
  standoff::read_changed(data, size);
  return 0;
}
