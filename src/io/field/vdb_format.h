// SPDX-License-Identifier: Apache-2.0
// What OpenVDB's files are made of.
#pragma once

#include <cstdint>
#include <string_view>

#include "files/atomic_file.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff::vdb {

inline constexpr std::uint64_t kMagic = 0x56444220;
inline constexpr std::uint32_t kVersion = 224;
inline constexpr std::uint32_t kOldest = 222;  ///< the first one whose values are stored as they are since
inline constexpr std::string_view kNoId = "00000000-0000-0000-0000-000000000000";  ///< equal fields make equal files
inline constexpr std::string_view kFloatTree = "Tree_float_5_4_3", kHalfSuffix = "_HalfFloat";

/// Bits of a grid's compression.
inline constexpr std::uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;

/// How the values of a node that are not active are found.
enum class ValuesKind : std::uint8_t {
  background,              ///< all of them are
  negative,                ///< all are -background
  one,                     ///< all are a value that follows
  background_or_negative,  ///< a mask says which are the background
  background_or_one,       ///< a value follows, and a mask of those that are the background
  two,                     ///< two values follow, and a mask of those that are the second
  all,                     ///< every value is stored
};

inline constexpr const char *kSizeFact = "standoff_size", *kThicknessFact = "standoff_thickness",
                            *kMethodFact = "standoff_method", *kHashFact = "standoff_mesh_hash",
                            *kVersionFact = "standoff_version", *kSignFact = "standoff_sign", *kUpFact = "standoff_up";

void write_vdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options);

}  // namespace standoff::vdb
