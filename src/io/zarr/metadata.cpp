// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/metadata.h"

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
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
#include "standoff/error.h"

namespace standoff::zarr {
namespace {

constexpr int kDeepest = 32;
constexpr const char* kCodecsThatWork =
    "standoff reads chunks of transpose [2,1,0] or none, bytes (little endian), blosc or nothing, and crc32c or "
    "nothing, in that order, in shards (sharding_indexed) or alone; write the store so";

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
  enum { kArrays, kBytes, kPacked, kChecked } reached = kArrays;
  layout.x_fastest = layout.blosc = layout.checked = false;
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
    } else if (codec.name == "crc32c" && (reached == kBytes || reached == kPacked)) {
      layout.checked = true;
      reached = kChecked;
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

// What the group of a store says of a level.
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

Level read_level(const JsonView& set) {
  Level level;
  const JsonView path = need(set, "path");
  level.array = path.text();
  const std::filesystem::path name(level.array);
  if (name.empty() || name.is_absolute() || std::ranges::find(name, "..") != name.end())
    path.fail(in_quotes(level.array) + " is no array of this store; write it again");
  read_transformations(need(set, "coordinateTransformations"), level);
  return level;
}

struct Group {
  std::vector<Level> levels;
  bool own = false;  // standoff wrote it, and so its arrays' attributes
};

Group read_group(const JsonView& json) {
  expect_version(json, "group");
  expect_known(json, {"zarr_format", "node_type", "attributes", "consolidated_metadata"});
  Group group;
  const auto attributes = json.find("attributes");
  group.own = attributes && attributes->find(kOwnAttributes);
  const auto ome = attributes ? attributes->find("ome") : std::nullopt;
  const auto scales = ome ? ome->find("multiscales") : std::nullopt;
  const auto image = scales ? first_of(*scales) : std::nullopt;
  if (!image) {
    group.levels.emplace_back();
    return group;
  }
  std::vector<std::string> axes;
  const JsonView named_axes = need(*image, "axes");
  named_axes.each_element([&](const JsonView& axis) { axes.push_back(need(axis, "name").text()); });
  if (!std::ranges::equal(axes, kAxes, {}, {}, [](const char* axis) { return std::string(axis); }))
    named_axes.fail("axes are read in the order x, y, z; transpose the array and write it again");
  const JsonView sets = need(*image, "datasets");
  sets.each_element([&](const JsonView& set) {
    if (group.levels.size() == kMostLevels)
      set.fail("more than " + std::to_string(kMostLevels) + " levels are not read; write fewer");
    group.levels.push_back(read_level(set));
  });
  if (group.levels.empty()) sets.fail("it lists no array; write the store again");
  return group;
}

void check_sum(const JsonView& own, const ArrayLayout& layout, const std::string& members) {
  const auto sum = own.find(kSum);
  if (sum && sum->whole() != sum_of(layout, members))
    sum->fail(std::string("it is not the checksum of this metadata, which is damaged, or was changed; write the store "
                          "again, or leave \"") +
              kSum + "\" out where the change is meant");
}

// The attributes of standoff.
std::optional<JsonView> own_attributes(const JsonView& array) {
  const auto attributes = array.find("attributes");
  return attributes ? attributes->find(kOwnAttributes) : std::nullopt;
}

// Grid, thickness and provenance; returns whether there are nearest triangles.
bool read_attributes(const FileView& file, const JsonView& array, const std::optional<Level>& level,
                     StoreMetadata& store) {
  const auto own = own_attributes(array);
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
  store.provenance = {text("method"), 0, text("version"), text("sign"), axis_in(text("up"))};
  if (const auto hash = own->find("mesh_hash")) {
    const auto number = hash_in(hash->text());
    if (!number) hash->fail("the mesh's hash is not of the form 0x0123456789abcdef; repair the file");
    store.provenance.mesh_hash = *number;
  }
  const auto found = own->find("nearest");
  const bool nearest = found && found->boolean();
  check_sum(*own, store.distance, own_members(store, nearest));
  if (own->find(kSum) && level && level->scale &&
      (*level->scale != store.grid.spacing || level->translation != store.grid.origin))
    FileView(store.path / kMetadataName, std::string_view())
        .fail("multiscales", "scale and translation of " + in_quotes(level->array) +
                                 " are not the spacing and origin that its array has; write the store again");
  return nearest;
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

FileView metadata_in(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / kMetadataName;
  const Descriptor file = open_stored(path, "metadata is");
  const FileView shown(path, std::string_view());
  struct stat about {};
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) shown.fail(cannot_read(errno));
  if (static_cast<std::uint64_t>(about.st_size) > kMostMetadataBytes)
    shown.fail("it has more than " + std::to_string(kMostMetadataBytes >> 20) +
               " MiB, where metadata takes some thousand bytes; write the store again");
  return FileView(path, file, kMostMetadataBytes);
}

void read_nearest(const std::filesystem::path& path, StoreMetadata& store) {
  const FileView file = metadata_in(path / kNearestName);
  store.nearest = layout_in(file, path / kNearestName, true);
  if (const auto own = own_attributes(json_of(file))) check_sum(*own, *store.nearest, "");
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

ArrayLayout read_array(const FileView& file) {
  const JsonView json = json_of(file);
  expect_version(json, "array");
  expect_known(json, {"zarr_format", "node_type", "shape", "data_type", "dimension_names", "chunk_grid",
                      "chunk_key_encoding", "fill_value", "codecs", "attributes", "storage_transformers"});
  ArrayLayout layout{.shape = sizes(need(json, "shape"))};
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

Descriptor open_stored(const std::filesystem::path& path, const char* what) {
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));  // a pipe would wait
  const FileView shown(path, std::string_view());
  struct stat about {};
  if (file.number() < 0 && errno == ENOENT) {
    if (::lstat(path.c_str(), &about) == 0) shown.fail("it is a link to what is not there; write the store again");
    errno = ENOENT;
    return file;
  }
  if (file.number() < 0 && errno == ENOTDIR) shown.fail("a file is where its folder should be; write the store again");
  if (file.number() < 0 || ::fstat(file.number(), &about) != 0) shown.fail(cannot_read(errno));
  if (!S_ISREG(about.st_mode)) shown.fail(std::string("it is no regular file, as ") + what + "; write the store again");
  return file;
}

StoreMetadata read_store(const std::filesystem::path& path, int level) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::not_found) fail_no_store(path, "no such file; check the name");
  if (!std::filesystem::exists(status)) fail_no_store(path, cannot_read(error.value()));
  if (!std::filesystem::is_directory(status))
    fail_no_store(path, "it is a file, and a Zarr store is a folder; check the name");
  const auto holds = [&](const char* name) {
    std::error_code ignored;
    return std::filesystem::symlink_status(path / name, ignored).type() != std::filesystem::file_type::not_found;
  };
  if (!holds(kMetadataName))
    fail_no_store(path, holds(".zgroup") || holds(".zarray")
                            ? "it is a store of version 2 of Zarr, and version 3 is read; write it again in that"
                            : "the folder holds no zarr.json, as every store of Zarr 3 does; check the name");
  StoreMetadata store{.path = path};
  const FileView top = metadata_in(path);
  const JsonView json = json_of(top);
  std::filesystem::path folder = path;
  Group group;
  if (need(json, "node_type").text() != "array") {
    group = read_group(json);
    store.levels = static_cast<int>(group.levels.size());
  }
  store.own = group.own;
  if (level < 0 || level >= store.levels)
    throw Error(ErrorCode::usage, path.string() + ": there is no level " + std::to_string(level) + "; it has " +
                                      (store.levels == 1 ? std::string("level 0 alone")
                                                         : "levels 0 to " + std::to_string(store.levels - 1)) +
                                      "; give one that it has");
  std::optional<Level> found;
  if (!group.levels.empty()) {
    found = group.levels[static_cast<std::size_t>(level)];
    folder /= found->array;
  }
  const FileView file = metadata_in(folder);
  const JsonView array = json_of(file);
  store.distance = layout_in(file, folder, false);
  if (group.own && !own_attributes(array))
    file.fail("its attributes lack \"standoff\", which the store says that it has; write the store again");
  if (read_attributes(file, array, found, store) && found) read_nearest(path, store);
  check(file, store);
  return store;
}

namespace {

// What a store that standoff wrote holds, and nothing else: a file of somebody else is not to be removed with it.
bool is_of_store(const std::filesystem::path& name) {
  const auto first = name.begin();
  if (name == kMetadataName) return true;
  const std::string array = first->string();
  if (array != kNearestName && array.find_first_not_of("0123456789") != std::string::npos) return false;
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

bool is_own_array(const std::filesystem::path& folder) {
  const FileView file = metadata_in(folder);
  return own_attributes(json_of(file)).has_value();
}

// Whether the folders that are called as levels are ours.
bool has_own_levels_alone(const std::filesystem::path& folder) {
  return all_entries(folder, [&](const std::string_view name, bool) {
    return name.find_first_not_of("0123456789") != std::string_view::npos || is_own_array(folder / name);
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
  return is_own_array(path / kDistanceName) && std::filesystem::exists(path / kMetadataName) &&
         holds_a_store_alone(path) && has_own_levels_alone(path);
} catch (const Error& error) {
  if (error.code() != ErrorCode::input) throw;  // such as memory that runs out
  return false;
}

}  // namespace standoff::zarr
