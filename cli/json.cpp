// SPDX-License-Identifier: Apache-2.0
#include "cli/json.h"

#include <cmath>

#include "cli/files.h"
#include "standoff/version.h"

namespace standoff::cli {
namespace {

std::string indented(const Json& json, const std::string& indent) {
  const bool is_list = json.is_array() && !json.empty() && json.front().is_object();
  // File names may hold bytes that are no UTF-8; they are shown as replacement characters.
  const auto dump = [](const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); };
  if (!is_list && (!json.is_object() || json.empty())) return dump(json);
  std::string text;
  for (const auto& [key, value] : json.items()) {
    text += (text.empty() ? "\n" : ",\n") + indent + "  ";
    if (!is_list) text += dump(key) + ": ";
    text += indented(value, indent + "  ");
  }
  return (is_list ? "[" : "{") + text + "\n" + indent + (is_list ? "]" : "}");
}

}  // namespace

Json json_answer(const char* verb) { return {{"schema", kJsonSchema}, {"version", version()}, {"verb", verb}}; }

Json json_number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Json json_point(Vec3 v) { return {v.x, v.y, v.z}; }
Json json_size(Size3 size) { return {size.x, size.y, size.z}; }
Json json_box(const Box& box) { return {json_point(box.min), json_point(box.max)}; }

Json json_grid(const Grid& grid) {
  return {{"size", json_size(grid.size)}, {"origin", json_point(grid.corner())}, {"spacing", json_point(grid.spacing)}};
}

Json json_triangle(std::uint32_t triangle) {
  if (triangle == kNoTriangle) return nullptr;
  return triangle;
}

Json json_output(const std::filesystem::path& path) {
  return {{"file", path.string()}, {"bytes", written_bytes(path)}};
}

std::string json_text(const Json& json) { return indented(json, "") + "\n"; }

}  // namespace standoff::cli
