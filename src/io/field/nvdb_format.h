// SPDX-License-Identifier: Apache-2.0
// Where NanoVDB keeps what, in bytes from the beginning of each structure: of its ABI 32, NanoVDB.h.
#pragma once

#include <cstdint>

#include "files/atomic_file.h"
#include "standoff/field.h"
#include "standoff/io.h"

namespace standoff::nvdb {

inline constexpr std::uint64_t kMagic = 0x304244566f6e614e;      ///< "NanoVDB0": of files and grids
inline constexpr std::uint64_t kMagicGrid = 0x314244566f6e614e;  ///< of grids since version 32.6
inline constexpr std::uint64_t kMagicFile = 0x324244566f6e614e;  ///< of files since then
inline constexpr std::uint32_t kMajor = 32, kVersion = kMajor << 21 | 4u << 10 | 2;
inline constexpr std::uint32_t kFloat = 1, kLevelSet = 1;  ///< type and class of a grid
enum class Codec : std::uint16_t { none, zip, blosc };

namespace file {
inline constexpr std::uint64_t kHeaderBytes = 16, kGridCount = 12, kCodec = 14;
inline constexpr std::uint64_t kMetaBytes = 176;
inline constexpr std::uint64_t kGridSize = 0, kFileSize = 8, kNameKey = 16, kVoxelCount = 24, kType = 32, kClass = 36,
                               kWorldBox = 40, kIndexBox = 88, kVoxelSize = 112, kNameSize = 136, kNodeCount = 140,
                               kMetaCodec = 168, kMetaVersion = 172;
}  // namespace file

namespace grid {
inline constexpr std::uint64_t kBytes = 672;
inline constexpr std::uint64_t kChecksum = 8, kVersionAt = 16, kFlags = 20, kCount = 28, kSize = 32, kName = 40,
                               kMatrixF = 296, kInverseF = 332, kVectorF = 368, kTaperF = 380, kMatrix = 384,
                               kInverse = 456, kVector = 528, kTaper = 552, kWorldBox = 560, kVoxelSize = 608,
                               kClass = 632, kType = 636, kBlindOffset = 640, kBlindCount = 648;
inline constexpr std::uint32_t kHasBox = 2, kHasMinMax = 4, kBreadthFirst = 32;
}  // namespace grid

namespace tree {
inline constexpr std::uint64_t kBytes = 64, kNodeOffset = 0, kNodeCount = 32, kVoxelCount = 56;
}

namespace root {
inline constexpr std::uint64_t kBytes = 64, kTableSize = 24, kBackground = 28, kMinimum = 32, kMaximum = 36;
inline constexpr std::uint64_t kTileBytes = 32, kChild = 8, kState = 16, kValue = 20;
}  // namespace root

/// Of inner nodes of 2^log children per axis: a box, flags, two masks, statistics, a table of children or values.
template <int log>
struct Inner {
  static constexpr std::uint64_t kChildren = std::uint64_t{1} << 3 * log, kMask = kChildren / 8;
  static constexpr std::uint64_t kValueMask = 32, kChildMask = kValueMask + kMask, kMinimum = kChildMask + kMask,
                                 kMaximum = kMinimum + 4, kTable = kMinimum + 32, kBytes = kTable + 8 * kChildren;
};
static_assert(Inner<5>::kBytes == 270400 && Inner<4>::kBytes == 33856);

namespace leaf {
inline constexpr std::uint64_t kBytes = 2144, kBoxMin = 0, kBoxSpan = 12, kFlags = 15, kMask = 16, kMinimum = 80,
                               kMaximum = 84, kValues = 96;
}

namespace blind {
inline constexpr std::uint64_t kBytes = 288, kOffset = 0, kElements = 8, kDataType = 28, kName = 32;
}

/// The blind data that standoff adds: lines "name=value".
inline constexpr const char* kFacts = "standoff";

void write_nvdb(AtomicFile& file, const DistanceField& field, const FieldWriteOptions& options);

}  // namespace standoff::nvdb
