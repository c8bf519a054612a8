// SPDX-License-Identifier: Apache-2.0
// How a store's zarr.json is written, and the words that its reader shares.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "io/zarr/metadata.h"

namespace standoff::zarr {

/// Of the attributes that standoff writes.
inline constexpr std::uint64_t kFormat = 1;
inline constexpr const char *kOwnAttributes = "standoff", *kSum = "metadata_crc32c";
inline constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
inline constexpr const char *kInfinity = "Infinity", *kMinusInfinity = "-Infinity", *kNotANumber = "NaN";

/// The text of an array's zarr.json. `attributes`: JSON.
std::string array_text(const ArrayLayout& layout, const std::string& attributes);
/// The members of our attributes, but for the checksum.
std::string own_members(const StoreMetadata& store, bool nearest);
/// What the checksum of an array's metadata is of: all that its samples depend on, however it is written down.
std::uint32_t sum_of(const ArrayLayout& layout, const std::string& members);

}  // namespace standoff::zarr
