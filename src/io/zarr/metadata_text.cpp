// SPDX-License-Identifier: Apache-2.0
// How zarr.json is written.
#include <bit>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/number_text.h"
#include "io/zarr/blosc.h"
#include "io/zarr/metadata.h"
#include "io/zarr/parts.h"
#include "io/zarr/shard.h"

namespace standoff::zarr {
namespace {

// Texts of provenance are ASCII; other bytes might be no UTF-8, and then nobody could read the JSON.
std::string quoted_text(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string json = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 128) {
      json += '?';
    } else if (byte < 32) {
      json.append("\\u00").append(1, kDigits[byte / 16]).append(1, kDigits[byte % 16]);
    } else {
      if (c == '"' || c == '\\') json += '\\';
      json += c;
    }
  }
  return json + '"';
}

std::string member(const char* name, const std::string& value) { return std::string("\"") + name + "\": " + value; }

// JSON has no infinite numbers: Zarr spells them so, and Python's float() reads that.
std::string number_json(double value) {
  return std::isfinite(value) ? exact_text(value) : std::string("\"") + (value < 0 ? kMinusInfinity : kInfinity) + '"';
}
std::string list_json(const Vec3& v) {
  return "[" + exact_text(v.x) + ", " + exact_text(v.y) + ", " + exact_text(v.z) + "]";
}
std::string list_json(const Size3& v) {
  return "[" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + "]";
}
std::string codec_json(const char* name, const std::string& configuration) {
  return R"({"name": ")" + std::string(name) + R"(", "configuration": {)" + configuration + "}}";
}

std::string chunk_codecs(const ArrayLayout& layout) {
  std::string codecs;
  if (layout.x_fastest) codecs += codec_json("transpose", R"("order": [2, 1, 0])") + ", ";
  codecs += codec_json("bytes", R"("endian": "little")");
  if (layout.blosc)
    codecs += ", " + codec_json("blosc", R"("cname": "zstd", "clevel": )" + std::to_string(kBloscLevel) +
                                             R"(, "shuffle": "shuffle", "typesize": )" + std::to_string(kNumberBytes) +
                                             R"(, "blocksize": 0)");
  if (layout.checked) codecs += R"(, {"name": "crc32c"})";
  return "[" + codecs + "]";
}

std::string codecs_json(const ArrayLayout& layout) {
  if (!layout.sharded) return chunk_codecs(layout);
  const std::string index = "[" + codec_json("bytes", R"("endian": "little")") + R"(, {"name": "crc32c"}])";
  return "[" +
         codec_json("sharding_indexed", member("chunk_shape", list_json(layout.chunk)) + ", " +
                                            member("codecs", chunk_codecs(layout)) + ", " +
                                            member("index_codecs", index) + ", " +
                                            member("index_location", layout.index_first ? R"("start")" : R"("end")")) +
         "]";
}

}  // namespace

std::string array_text(const ArrayLayout& layout, const std::string& attributes) {
  const std::string fill = layout.whole_numbers ? std::to_string(layout.fill)
                                                : number_json(static_cast<double>(std::bit_cast<float>(layout.fill)));
  const std::vector<std::string> members{
      member("zarr_format", "3"),
      member("node_type", "\"array\""),
      member("shape", list_json(layout.shape)),
      member("data_type", layout.whole_numbers ? "\"uint32\"" : "\"float32\""),
      member("dimension_names", R"(["x", "y", "z"])"),
      member("chunk_grid", codec_json("regular", member("chunk_shape", list_json(layout.shard)))),
      member("chunk_key_encoding",
             codec_json("default", member("separator", quoted_text(std::string_view(&layout.separator, 1))))),
      member("fill_value", fill),
      member("codecs", codecs_json(layout)),
      member("attributes", "{" + attributes + "}")};
  std::string text;
  for (const std::string& one : members) text += (text.empty() ? "{\n  " : ",\n  ") + one;
  return text + "\n}\n";
}

std::string own_members(const StoreMetadata& store, bool nearest) {
  const Provenance& from = store.provenance;
  return member("format", std::to_string(kFormat)) + ", " + member("origin", list_json(store.grid.origin)) + ", " +
         member("spacing", list_json(store.grid.spacing)) + ", " + member("thickness", number_json(store.thickness)) +
         ", " + member("nearest", nearest ? "true" : "false") + ", " + member("method", quoted_text(from.method)) +
         ", " + member("sign", quoted_text(from.sign)) + ", " +
         member("mesh_hash", quoted_text(hash_text(from.mesh_hash))) + ", " +
         member("version", quoted_text(from.version)) +
         (from.up ? ", " + member("up", quoted_text(axis_text(from.up))) : "");
}

std::uint32_t sum_of(const ArrayLayout& layout, const std::string& members) {
  const std::string text = array_text(layout, members);
  return crc32c(std::as_bytes(std::span(text)));
}

StoreMetadata level_of(const StoreMetadata& store, int number) {
  StoreMetadata level = store;
  const std::int64_t step = std::int64_t{1} << number;
  level.grid.size = parts_of(store.grid.size, {step, step, step});
  level.grid.spacing = store.grid.spacing * static_cast<double>(step);
  level.distance.shape = level.grid.size;
  level.distance.folder = store.distance.folder.parent_path() / std::to_string(number);
  if (number > 0) level.nearest.reset();
  return level;
}

namespace {

std::string text_with_sum(const ArrayLayout& layout, const std::string& members) {
  const std::string sum = member(kSum, std::to_string(sum_of(layout, members)));
  return array_text(layout, member(kOwnAttributes, "{" + members + (members.empty() ? "" : ", ") + sum + "}"));
}

}  // namespace

std::string distance_text(const StoreMetadata& store) {
  return text_with_sum(store.distance, own_members(store, store.nearest.has_value()));
}
std::string nearest_text(const StoreMetadata& store) { return text_with_sum(*store.nearest, ""); }

std::string group_text(const StoreMetadata& store) {
  std::string axes, sets;
  for (const char* axis : kAxes) {
    if (!axes.empty()) axes += ", ";
    axes.append("{").append(member("name", quoted_text(axis))).append(R"(, "type": "space"})");
  }
  for (int number = 0; number < store.levels; ++number) {
    const Grid grid = level_of(store, number).grid;
    sets += (number > 0 ? ", " : "") + std::string("{") + member("path", quoted_text(std::to_string(number))) +
            R"(, "coordinateTransformations": [{"type": "scale", "scale": )" + list_json(grid.spacing) +
            R"(}, {"type": "translation", "translation": )" + list_json(grid.origin) + "}]}";
  }
  return std::string("{\n  \"zarr_format\": 3,\n  \"node_type\": \"group\",\n  \"attributes\": {") +
         member(kOwnAttributes, "{" + member("format", std::to_string(kFormat)) + "}") +
         ",\n    \"ome\": {\"version\": \"0.5\", \"multiscales\": [{\"name\": \"distance\", " +
         (store.levels > 1 ? R"("type": "decimation", )" : "") + "\"axes\": [" + axes + "], \"datasets\": [" + sets +
         "]}]}}\n}\n";
}

}  // namespace standoff::zarr
