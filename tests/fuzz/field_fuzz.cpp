// SPDX-License-Identifier: Apache-2.0
// The fuzzer of a field reader. CMakeLists.txt makes one of it for each row of the table of formats, STANDOFF_FORMAT.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "io/field/format.h"
#include "io/field/npy.h"
#include "standoff/error.h"
#include "standoff/io.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

// Reads bytes as a file: an error, or a field whose values keep its promise; anything else ends the process.
void read_bytes_as_field(std::string_view bytes) {
  const FileView view("fuzz", bytes);
  try {
    // A tree of few bytes may span a grid of many samples.
    const FieldFile file = STANDOFF_FORMAT.read(view, {.memory_limit = std::int64_t{64} << 20});
    const DistanceField& field = file.field;
    for (const Sidecar& sidecar : file.sidecars) {
      const std::size_t numbers = std::visit([](const auto& values) { return values.size(); }, sidecar.values);
      if (numbers != field.tile_values().size() * static_cast<std::size_t>(sidecar.components)) std::abort();
    }
    if (!(field.thickness() > 0)) std::abort();
    for (const float value : field.tile_values())
      if (!(std::abs(value) <= static_cast<float>(field.thickness()))) std::abort();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::input && error.code() != ErrorCode::limit) std::abort();
  }
}

std::string good_tree() {
  const TempFolder folder;
  DistanceField field({{20, 17, 9}, {1, 2, 3}, {0.5, 1, 2}}, 1);
  const auto values = field.store_tile(1, 1, 0);
  for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<float>(n) / 256 - 1;
  field.mark_inside(0, 1, 1);
  const auto path = folder / (std::string("a.") + STANDOFF_FORMAT.extension);
  write_field(path, field);
  return read_bytes(path);
}

// Trees have long tables that say nothing, so the bytes are also taken as changes to a good file: where, and what
// stands there then.
void read_changed_tree(const std::uint8_t* data, std::size_t size) {
  static const std::string good = good_tree();
  std::string bytes = good;
  for (std::size_t at = 0; at + 4 <= size; at += 4) {
    std::uint32_t change;
    std::memcpy(&change, data + at, sizeof change);
    bytes[(change >> 8) % bytes.size()] = static_cast<char>(change & 0xFF);
  }
  read_bytes_as_field(bytes);
}

// Checksums keep damaged arrays of an archive from their reader, so it also gets the bytes themselves.
void read_bytes_as_array(std::string_view bytes) {
  const FileView view("fuzz", bytes);
  try {
    const NpyArray array = read_npy(view, "array", view.bytes(), bytes.size());
    if (array.offset + array.bytes != bytes.size()) std::abort();
  } catch (const Error&) {
  }
}

}  // namespace
}  // namespace standoff

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  standoff::read_bytes_as_field(bytes);
  if (standoff::STANDOFF_FORMAT.sparse) standoff::read_changed_tree(data, size);
  if (standoff::STANDOFF_FORMAT.extension == std::string_view("npz")) standoff::read_bytes_as_array(bytes);
  return 0;
}
