// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include "files/zip_format.h"
#include "mesh_fuzz.h"

namespace {

template <class Number>
std::string raw(Number value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

// An archive of one model part, not packed: damaged checksums would keep the bytes from the reader of the model.
std::string archive_of(std::string_view model) {
  using namespace standoff;
  const std::string name = "3D/3dmodel.model";
  const auto crc = static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(model.data()), model.size()));
  const auto bytes = static_cast<std::uint32_t>(model.size());
  const std::string common = raw(std::uint16_t{20}) + raw(std::uint32_t{0}) + raw(std::uint32_t{0}) + raw(crc) +
                             raw(bytes) + raw(bytes) + raw(static_cast<std::uint16_t>(name.size())) +
                             raw(std::uint16_t{0});
  std::string archive = raw(zip::kLocalHeader) + common + name + std::string(model);
  const auto directory = static_cast<std::uint32_t>(archive.size());
  archive += raw(zip::kDirectoryHeader) + raw(std::uint16_t{20}) + common + std::string(14, '\0') + name;
  const auto size = static_cast<std::uint32_t>(archive.size()) - directory;
  return archive + raw(zip::kDirectoryEnd) + raw(std::uint32_t{0}) + raw(std::uint16_t{1}) + raw(std::uint16_t{1}) +
         raw(size) + raw(directory) + raw(std::uint16_t{0});
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto read = [](const standoff::FileView& file) {
    standoff::MeshReadReport report;
    return standoff::read_3mf(file, report);
  };
  const std::string archive = archive_of({reinterpret_cast<const char*>(data), size});
  standoff::fuzz_mesh(read, reinterpret_cast<const std::uint8_t*>(archive.data()), archive.size());
  return standoff::fuzz_mesh(read, data, size);
}
