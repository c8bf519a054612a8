// The directory of a zip archive.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/field/input.h"

namespace standoff {

struct ZipMember {
  std::string name;
  std::uint64_t offset = 0;  ///< of its first byte
  std::uint64_t bytes = 0;
  std::uint32_t crc = 0;
};

/// The members of an archive, each of them uncompressed and within the file. Errors: input, also for archives that are
/// compressed, encrypted or split.
std::vector<ZipMember> read_zip(const FieldInput& file);

/// Throws Error{input} unless the bytes of a member have its checksum.
void check_crc(const FieldInput& file, const ZipMember& member);

}  // namespace standoff
