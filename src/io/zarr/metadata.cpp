// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/metadata.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "core/number_text.h"
#include "files/atomic_folder.h"
#include "files/json_view.h"
#include "io/zarr/blosc.h"
#include "standoff/error.h"

namespace standoff::zarr {
namespace {

// Of the attributes that standoff writes.
constexpr std::uint64_t kFormat = 1;
constexpr int kDeepest = 32;
constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
constexpr const char *kInfinity = "Infinity", *kMinusInfinity = "-Infinity", *kNotANumber = "NaN";
constexpr const char* kCodecsThatWork =
    "standoff reads chunks of transpose [2,1,0] or none, bytes (little endian) and blosc or nothing, in that order, in "
    "shards (sharding_indexed) or alone; write the store so";

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

// What a member is called, or what a codec is: its name alone, or an object with the name and its configuration.
struct Named {
  std::string name;
  std::optional<JsonView> configuration;
  JsonView json;
};

JsonView need(const JsonView& object, const char* name) {
  const auto found = object.find(name);
  if (!found) object.fail(std::string("it lacks \"") + name + "\"; write the store again");
  return *found;
}

Named named(const JsonView& json) {
  if (json.kind() == JsonView::Kind::string) return {json.text(), {}, json};
  return {need(json, "name").text(), json.find("configuration"), json};
}

JsonView need(const Named& what, const char* name) {
  if (!what.configuration) what.json.fail(in_quotes(what.name) + " lacks its configuration; write the store again");
  return need(*what.configuration, name);
}

Size3 sizes(const JsonView& json) {
  if (json.size() != 3)
    json.fail("it has " + std::to_string(json.size()) + " numbers, where a field has 3 axes; write the store again");
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  Size3 sizes;
  std::size_t axis = 0;
  json.each_element([&](const JsonView& size) {
    const std::uint64_t number = size.whole();
    if (number < 1 || number > kMost) size.fail("a size is 1 to 2^40; write the store again");
    sizes[axis++] = static_cast<std::int64_t>(number);
  });
  return sizes;
}

double number_or_word(const JsonView& json) {
  if (json.kind() != JsonView::Kind::string) return json.number();
  const std::string word = json.text();
  if (word == kInfinity) return std::numeric_limits<double>::infinity();
  if (word == kMinusInfinity) return -std::numeric_limits<double>::infinity();
  if (word == kNotANumber) return std::numeric_limits<double>::quiet_NaN();
  json.fail("expected a number, \"Infinity\" or \"NaN\"; found " + in_quotes(word) + "; repair the file");
}

Vec3 vector(const JsonView& json) {
  if (json.size() != 3)
    json.fail("it has " + std::to_string(json.size()) + " numbers, where a field has 3 axes; write the store again");
  std::array<double, 3> numbers{};
  std::size_t axis = 0;
  json.each_element([&](const JsonView& number) { numbers[axis++] = number.number(); });
  return {numbers[0], numbers[1], numbers[2]};
}

std::uint32_t fill_bits(const JsonView& json, bool whole_numbers) {
  if (whole_numbers) {
    const std::uint64_t number = json.whole();
    if (number > 0xffffffff) json.fail("the fill value is no uint32; write the store again");
    return static_cast<std::uint32_t>(number);
  }
  if (json.kind() == JsonView::Kind::string && json.text().starts_with("0x")) {
    const std::string word = json.text();
    std::uint32_t bits = 0;
    const auto [end, error] = std::from_chars(word.data() + 2, word.data() + word.size(), bits, 16);
    if (error != std::errc{} || end != word.data() + word.size() || word.size() != 10)
      json.fail("the fill value is no float32; write the store again");
    return bits;
  }
  return std::bit_cast<std::uint32_t>(static_cast<float>(number_or_word(json)));
}

// A member that we do not know may change what the others mean, unless it says that it does not.
void expect_known(const JsonView& json, std::initializer_list<std::string_view> known) {
  json.each_member([&](const std::string& name, const JsonView& value) {
    if (std::ranges::find(known, name) != known.end()) return;
    if (value.kind() == JsonView::Kind::object)
      if (const auto must = value.find("must_understand"); must && !must->boolean()) return;
    value.fail("its member " + in_quotes(name) + " is unknown here; write the store without it");
  });
}

void expect_version(const JsonView& json, const char* node) {
  if (const JsonView version = need(json, "zarr_format"); version.whole() != 3)
    version.fail("it is of version " + std::to_string(version.whole()) +
                 " of Zarr, and version 3 is read; write the store again in that");
  if (const JsonView type = need(json, "node_type"); type.text() != node)
    type.fail("it is of type " + in_quotes(type.text()) + ", where " + node + " is expected; write the store again");
}

// The codecs of a chunk.
void read_chunk_codecs(const JsonView& json, ArrayLayout& layout) {
  enum { kArrays, kBytes, kPacked } reached = kArrays;
  layout.x_fastest = layout.blosc = false;
  const auto not_read = [](const Named& codec) {
    codec.json.fail("codec " + in_quotes(codec.name) + " is not read here; " + kCodecsThatWork);
  };
  json.each_element([&](const JsonView& element) {
    const Named codec = named(element);
    if (codec.name == "transpose" && reached == kArrays && !layout.x_fastest) {
      const JsonView order = need(codec, "order");
      std::vector<std::uint64_t> axes;
      order.each_element([&](const JsonView& axis) { axes.push_back(axis.whole()); });
      layout.x_fastest = axes == std::vector<std::uint64_t>{2, 1, 0};
      if (!layout.x_fastest && axes != std::vector<std::uint64_t>{0, 1, 2})
        order.fail(std::string("axes in this order are not read; ") + kCodecsThatWork);
    } else if (codec.name == "bytes" && reached == kArrays) {
      const JsonView endian = need(codec, "endian");
      if (endian.text() != "little")
        endian.fail(in_quotes(endian.text()) + " endian bytes are not read; " + kCodecsThatWork);
      reached = kBytes;
    } else if (codec.name == "blosc" && reached == kBytes) {
      layout.blosc = true;
      reached = kPacked;
    } else {
      not_read(codec);
    }
  });
  if (reached == kArrays) json.fail(std::string("codec 'bytes' is missing; ") + kCodecsThatWork);
}

void read_index_codecs(const JsonView& json) {
  std::vector<Named> codecs;
  json.each_element([&](const JsonView& codec) { codecs.push_back(named(codec)); });
  if (codecs.size() != 2 || codecs[0].name != "bytes" || codecs[1].name != "crc32c" ||
      need(codecs[0], "endian").text() != "little")
    json.fail("the index of a shard is read of bytes (little endian) with a crc32c alone; write the store so");
}

void read_codecs(const JsonView& json, ArrayLayout& layout) {
  std::optional<Named> sharding;
  json.each_element([&](const JsonView& element) {
    const Named codec = named(element);
    if (codec.name == "sharding_indexed") sharding = codec;
  });
  layout.sharded = sharding.has_value();
  layout.chunk = layout.shard;
  if (!sharding) return read_chunk_codecs(json, layout);
  if (json.size() != 1) json.fail(std::string("codecs beside 'sharding_indexed' are not read; ") + kCodecsThatWork);
  const JsonView shape = need(*sharding, "chunk_shape");
  layout.chunk = sizes(shape);
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (layout.shard[axis] % layout.chunk[axis] != 0)
      shape.fail("a shard is no multiple of its chunks; write the store again");
  if (layout.chunks().count() > kMostChunks)
    shape.fail("a shard has more than " + std::to_string(kMostChunks) + " chunks; write larger ones");
  read_chunk_codecs(need(*sharding, "codecs"), layout);
  read_index_codecs(need(*sharding, "index_codecs"));
  if (const auto location = sharding->configuration->find("index_location")) {
    layout.index_first = location->text() == "start";
    if (!layout.index_first && location->text() != "end")
      location->fail("an index is at \"start\" or \"end\"; write the store again");
  }
}

void read_names(const JsonView& json, ArrayLayout& layout) {
  const Named encoding = named(json);
  if (encoding.name != "default")
    json.fail("chunks named by " + in_quotes(encoding.name) + " are not read; write them by \"default\"");
  const auto separator = encoding.configuration ? encoding.configuration->find("separator") : std::nullopt;
  const std::string text = separator ? separator->text() : "/";
  if (text != "/" && text != ".") separator->fail("the separator is \"/\" or \".\"; write the store again");
  layout.separator = text[0];
}

void expect_axes(const JsonView& json) {
  std::size_t axis = 0;
  json.each_element([&](const JsonView& name) {
    // An axis without a name is null.
    const bool good = name.kind() == JsonView::Kind::literal || (axis < 3 && name.text() == kAxes[axis]);
    if (!good) json.fail("axes are read in the order x, y, z; transpose the array and write it again");
    ++axis;
  });
}

// What the group of a store says of its first level.
struct Level {
  std::string array = kDistanceName;
  std::optional<Vec3> scale;
  Vec3 translation{};
};

void read_transformations(const JsonView& json, Level& level) {
  json.each_element([&](const JsonView& one) {
    const JsonView type = need(one, "type");
    if (type.text() == "scale") {
      level.scale = vector(need(one, "scale"));
    } else if (type.text() == "translation") {
      level.translation = vector(need(one, "translation"));
    } else {
      type.fail("a transformation of type " + in_quotes(type.text()) + " is not read; write scale and translation");
    }
  });
}

// The first element of a list.
std::optional<JsonView> first_of(const JsonView& list) {
  std::optional<JsonView> first;
  list.each_element([&](const JsonView& element) {
    if (!first) first = element;
  });
  return first;
}

Level read_group(const JsonView& json) {
  expect_version(json, "group");
  expect_known(json, {"zarr_format", "node_type", "attributes", "consolidated_metadata"});
  Level level;
  const auto attributes = json.find("attributes");
  const auto ome = attributes ? attributes->find("ome") : std::nullopt;
  const auto scales = ome ? ome->find("multiscales") : std::nullopt;
  const auto image = scales ? first_of(*scales) : std::nullopt;
  if (!image) return level;
  std::vector<std::string> axes;
  const JsonView named_axes = need(*image, "axes");
  named_axes.each_element([&](const JsonView& axis) { axes.push_back(need(axis, "name").text()); });
  if (!std::ranges::equal(axes, kAxes, {}, {}, [](const char* axis) { return std::string(axis); }))
    named_axes.fail("axes are read in the order x, y, z; transpose the array and write it again");
  const JsonView sets = need(*image, "datasets");
  const auto set = first_of(sets);
  if (!set) sets.fail("it lists no array; write the store again");
  const JsonView path = need(*set, "path");
  level.array = path.text();
  const std::filesystem::path name(level.array);
  if (name.empty() || name.is_absolute() || std::ranges::find(name, "..") != name.end())
    path.fail(in_quotes(level.array) + " is no array of this store; write it again");
  read_transformations(need(*set, "coordinateTransformations"), level);
  return level;
}

// Grid, thickness and provenance; returns whether there are nearest triangles.
bool read_attributes(const FileView& file, const JsonView& array, const std::optional<Level>& level,
                     StoreMetadata& store) {
  const auto attributes = array.find("attributes");
  const auto own = attributes ? attributes->find("standoff") : std::nullopt;
  store.grid.size = store.distance.shape;
  store.thickness = std::numeric_limits<double>::infinity();
  if (!own) {
    if (!level || !level->scale)
      file.fail(
          "its attributes lack \"standoff\", and its group has no multiscales of OME-Zarr: where its samples are is "
          "not known; add one of both");
    store.grid.spacing = *level->scale;
    store.grid.origin = level->translation;
    return false;
  }
  if (const JsonView format = need(*own, "format"); format.whole() != kFormat)
    format.fail("the store is of format " + std::to_string(format.whole()) + ", and format " + std::to_string(kFormat) +
                " is read; get a newer standoff");
  store.grid.origin = vector(need(*own, "origin"));
  store.grid.spacing = vector(need(*own, "spacing"));
  if (const auto thickness = own->find("thickness")) store.thickness = number_or_word(*thickness);
  const auto text = [&](const char* name) {
    const auto found = own->find(name);
    return found ? found->text() : std::string();
  };
  store.provenance = {text("method"), 0, text("version"), text("sign")};
  if (const auto hash = own->find("mesh_hash")) {
    const auto number = hash_in(hash->text());
    if (!number) hash->fail("the mesh's hash is not of the form 0x0123456789abcdef; repair the file");
    store.provenance.mesh_hash = *number;
  }
  const auto nearest = own->find("nearest");
  return nearest && nearest->boolean();
}

void check(const FileView& file, const StoreMetadata& store) {
  if (!(store.thickness > 0))
    file.fail("the thickness " + exact_text(store.thickness) + " is not positive; write the store again");
  try {
    validate(store.grid);
  } catch (const Error& error) {
    file.fail(std::string(diagnosis(error.what())) + "; write the store again");
  }
}

StoredLayout layout_in(const FileView& file, const std::filesystem::path& folder, bool whole_numbers) {
  StoredLayout layout{read_array(file), folder};
  if (layout.whole_numbers != whole_numbers)
    file.fail(whole_numbers ? "nearest triangles are of type uint32; write them so"
                            : "distances are of type float32; write them so");
  return layout;
}

JsonView json_of(const FileView& file) {
  if (file.size() == 0) file.fail("the file is empty; write the store again");
  return JsonView::read(file, file.bytes(), kDeepest);
}

void read_nearest(const std::filesystem::path& path, StoreMetadata& store) {
  const FileView file(path / kNearestName / kMetadataName);
  store.nearest = layout_in(file, path / kNearestName, true);
  if (store.nearest->shape != store.distance.shape)
    file.fail("there are not as many nearest triangles as distances; write the store again");
}

[[noreturn]] void fail_no_store(const std::filesystem::path& path, const std::string& what) {
  throw Error(ErrorCode::input, path.string() + ": " + what, {.file = path.string()});
}

}  // namespace

std::filesystem::path ArrayLayout::file_name(const Size3& n) const {
  const std::string x = std::to_string(n.x), y = std::to_string(n.y), z = std::to_string(n.z);
  const std::string s(1, separator);
  return "c" + s + x + s + y + s + z;
}

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
      member("chunk_key_encoding", codec_json("default", R"("separator": "/")")),
      member("fill_value", fill),
      member("codecs", codecs_json(layout)),
      member("attributes", "{" + attributes + "}")};
  std::string text;
  for (const std::string& one : members) text += (text.empty() ? "{\n  " : ",\n  ") + one;
  return text + "\n}\n";
}

std::string field_attributes(const StoreMetadata& store) {
  const Provenance& from = store.provenance;
  return member(
      "standoff",
      "{" + member("format", std::to_string(kFormat)) + ", " + member("origin", list_json(store.grid.origin)) + ", " +
          member("spacing", list_json(store.grid.spacing)) + ", " + member("thickness", number_json(store.thickness)) +
          ", " + member("nearest", store.nearest ? "true" : "false") + ", " +
          member("method", quoted_text(from.method)) + ", " + member("sign", quoted_text(from.sign)) + ", " +
          member("mesh_hash", quoted_text(hash_text(from.mesh_hash))) + ", " +
          member("version", quoted_text(from.version)) + "}");
}

std::string group_text(const StoreMetadata& store) {
  std::string axes;
  for (const char* axis : kAxes) {
    if (!axes.empty()) axes += ", ";
    axes.append("{").append(member("name", quoted_text(axis))).append(R"(, "type": "space"})");
  }
  const std::string set = R"({"path": ")" + std::string(kDistanceName) +
                          R"(", "coordinateTransformations": [{"type": "scale", "scale": )" +
                          list_json(store.grid.spacing) + R"(}, {"type": "translation", "translation": )" +
                          list_json(store.grid.origin) + "}]}";
  return "{\n  \"zarr_format\": 3,\n  \"node_type\": \"group\",\n  \"attributes\": {\"ome\": {\"version\": \"0.5\", "
         "\"multiscales\": [{\"name\": \"distance\", \"axes\": [" +
         axes + "], \"datasets\": [" + set + "]}]}}\n}\n";
}

ArrayLayout read_array(const FileView& file) {
  const JsonView json = json_of(file);
  expect_version(json, "array");
  expect_known(json, {"zarr_format", "node_type", "shape", "data_type", "dimension_names", "chunk_grid",
                      "chunk_key_encoding", "fill_value", "codecs", "attributes", "storage_transformers"});
  ArrayLayout layout;
  layout.shape = sizes(need(json, "shape"));
  const Named type = named(need(json, "data_type"));
  layout.whole_numbers = type.name == "uint32";
  if (!layout.whole_numbers && type.name != "float32")
    type.json.fail("samples of type " + in_quotes(type.name) + " are not read; write float32");
  layout.fill = fill_bits(need(json, "fill_value"), layout.whole_numbers);
  if (const auto names = json.find("dimension_names"); names && names->kind() == JsonView::Kind::list)
    expect_axes(*names);
  const Named grid = named(need(json, "chunk_grid"));
  if (grid.name != "regular")
    grid.json.fail("chunks in a grid " + in_quotes(grid.name) + " are not read; write a regular one");
  layout.shard = sizes(need(grid, "chunk_shape"));
  read_names(need(json, "chunk_key_encoding"), layout);
  const JsonView codecs = need(json, "codecs");
  read_codecs(codecs, layout);
  if (layout.chunk.count() > kMostChunkBytes / 4)
    codecs.fail("a chunk has more than " + std::to_string(kMostChunkBytes >> 20) + " MiB; write smaller ones");
  if (const auto transformers = json.find("storage_transformers"); transformers && transformers->size() != 0)
    transformers->fail("storage transformers are not read; write the store without them");
  return layout;
}

StoreMetadata read_store(const std::filesystem::path& path) {
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) fail_no_store(path, "no such file; check the name");
  if (!std::filesystem::is_directory(status))
    fail_no_store(path, "it is a file, and a Zarr store is a folder; check the name");
  if (!std::filesystem::exists(path / kMetadataName, ignored))
    fail_no_store(
        path, std::filesystem::exists(path / ".zgroup", ignored) || std::filesystem::exists(path / ".zarray", ignored)
                  ? "it is a store of version 2 of Zarr, and version 3 is read; write it again in that"
                  : "the folder holds no zarr.json, as every store of Zarr 3 does; check the name");
  StoreMetadata store;
  store.path = path;
  const FileView top(path / kMetadataName);
  const JsonView json = json_of(top);
  std::filesystem::path folder = path;
  std::optional<Level> level;
  if (need(json, "node_type").text() != "array") {
    level = read_group(json);
    folder /= level->array;
  }
  const FileView file(folder / kMetadataName);
  store.distance = layout_in(file, folder, false);
  if (read_attributes(file, json_of(file), level, store) && level) read_nearest(path, store);
  check(file, store);
  return store;
}

namespace {

// What a store that standoff wrote holds, and nothing else: a file of somebody else is not to be removed with it.
bool is_of_store(const std::filesystem::path& name) {
  const auto first = name.begin();
  if (name == kMetadataName) return true;
  if (*first != kDistanceName && *first != kNearestName) return false;
  auto part = std::next(first);
  if (part == name.end() || (*part == kMetadataName && std::next(part) == name.end())) return true;
  if (*part != "c") return false;
  return std::all_of(std::next(part), name.end(), [](const std::filesystem::path& one) {
    const std::string text = one.string();
    const bool is_unfinished =
        text.starts_with(".standoff-") && text.ends_with(".part");  // of a writer that was killed
    return is_unfinished || text.find_first_not_of("0123456789") == std::string::npos;
  });
}

// `inner`: of the store, empty for all of it.
bool holds_a_store_alone(const std::filesystem::path& store, const std::filesystem::path& inner = {}) {
  return all_entries(store / inner, [&](const char* name, bool is_folder) {
    const std::filesystem::path entry = inner / name;
    return is_of_store(entry) && (!is_folder || holds_a_store_alone(store, entry));
  });
}

}  // namespace

bool is_own_store(const std::filesystem::path& path) try {
  const FileView file(path / kDistanceName / kMetadataName);
  const auto attributes = json_of(file).find("attributes");
  return attributes && attributes->find("standoff") && std::filesystem::exists(path / kMetadataName) &&
         holds_a_store_alone(path);
} catch (const Error& error) {
  if (error.code() != ErrorCode::input) throw;  // such as memory that runs out
  return false;
}

}  // namespace standoff::zarr
