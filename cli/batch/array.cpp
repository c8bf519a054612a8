// SPDX-License-Identifier: Apache-2.0
// The end of a batch whose results are rows of one array.
#include <limits>
#include <string>

#include "batch/field_array.h"
#include "cli/batch/manifest.h"
#include "cli/batch/sink.h"
#include "files/atomic_file.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

namespace fs = std::filesystem;

Vec3 vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

// 0 where it is no number of samples on an axis.
std::int64_t side_of(const Json& json) {
  constexpr std::int64_t kMost = std::int64_t{1} << 40;
  const std::int64_t side = json.is_number_integer() ? json.get<std::int64_t>() : 0;
  return side > kMost ? 0 : side;
}

}  // namespace

void end_array(const fs::path& folder, const FieldArrayLayout& layout, std::int64_t listed,
               const std::string& parameters) {
  FieldArray::Table table(listed);
  each_row(manifest_path(folder, {}), [&](const Json& row, const ManifestLine&) {
    const auto index = row.at("index").get<std::int64_t>();
    if (index < 0 || index >= listed) return;  // of an earlier, longer list
    const bool ours = row.at("parameters").get<std::string>() == parameters;
    const int code = ours ? row.at("code").get<int>() : FieldArray::kUnknown;
    table.code[static_cast<std::size_t>(index)] = static_cast<std::uint8_t>(code);
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    if (code != 0) return table.set(index, {kNone, kNone, kNone}, {kNone, kNone, kNone}, kNone);
    const Json &grid = row.at("grid"), &thickness = row.at("thickness");
    table.set(index, vector_of(grid.at("origin")), vector_of(grid.at("spacing")),
              thickness.is_number() ? thickness.get<double>() : std::numeric_limits<double>::infinity());
  });
  FieldArray(folder / kArrayName, layout).end(table);
}

std::optional<FieldArrayLayout> array_layout_of(const fs::path& folder, const std::string& parameters) {
  const fs::path path = folder / ("parameters-" + parameters + ".json");
  std::error_code ignored;
  if (!fs::exists(path, ignored)) return std::nullopt;
  try {
    const Json json = Json::parse(read_text(path));
    if (!json.contains("shape")) return std::nullopt;
    const Json& shape = json.at("shape");
    const FieldArrayLayout layout{{side_of(shape.at(0)), side_of(shape.at(1)), side_of(shape.at(2))},
                                  json.at("compress").get<bool>()};
    if (layout.shape.x > 0 && layout.shape.y > 0 && layout.shape.z > 0) return layout;
  } catch (const Json::exception&) {
  }
  throw Error(ErrorCode::input, path.string() + ": these are no parameters of a batch; run it again with --resume");
}

}  // namespace standoff::cli
