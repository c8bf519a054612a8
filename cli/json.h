// SPDX-License-Identifier: Apache-2.0
// What --json prints: one object per answer, whose keys docs/json.md lists.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff::cli {

using Json = nlohmann::ordered_json;

/// Grows when a key is renamed or removed, or changes its type or meaning; new keys alone leave it as it is.
inline constexpr int kJsonSchema = 1;

/// The beginning of a verb's answer: `schema`, `version` and `verb`.
Json json_answer(const char* verb);

/// The number, or null where JSON has none for it (infinity).
Json json_number(double value);
Json json_point(Vec3 v);
Json json_size(Size3 size);
Json json_box(const Box& box);
Json json_grid(const Grid& grid);
/// The index, or null for kNoTriangle.
Json json_triangle(std::uint32_t triangle);
/// A file that was written. A pipe has 0 bytes.
Json json_output(const std::filesystem::path& path);

/// The text of an answer: objects, and lists of objects, on lines of their own; points and other short lists on one.
std::string json_text(const Json& json);

}  // namespace standoff::cli
