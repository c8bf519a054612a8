// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/gltf_data.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "io/mesh/companion_file.h"

namespace standoff {
namespace {

std::uint64_t whole(const JsonView& json, std::string_view name, std::uint64_t otherwise) {
  const auto value = json.find(name);
  return value ? value->whole() : otherwise;
}

std::uint64_t required(const JsonView& json, const char* name) {
  const auto value = json.find(name);
  if (!value) json.fail(std::string("a member called ") + name + " is missing; repair the file");
  return value->whole();
}

}  // namespace

GltfPlace gltf_place(const JsonView& json) { return {required(json, "bufferView"), whole(json, "byteOffset", 0)}; }

GltfBuffers::GltfBuffers(const FileView& file, const std::optional<JsonView>& buffers,
                         const std::optional<JsonView>& views, std::optional<std::string_view> binary)
    : file_(file), binary_(binary) {
  if (buffers) {
    buffers_.reserve(buffers->size());
    buffers->each_element([&](const JsonView& json) {
      buffers_.push_back({json, required(json, "byteLength"), nullptr});
      longest_ = std::max(longest_, buffers_.back().length);
    });
  }
  if (!views) return;
  views_.reserve(views->size());
  views->each_element([&](const JsonView& json) {
    views_.push_back({required(json, "buffer"), whole(json, "byteOffset", 0), required(json, "byteLength"),
                      whole(json, "byteStride", 0)});
  });
}

GltfRows GltfBuffers::rows(const GltfPlace& place, std::uint64_t count, std::uint64_t bytes, const std::string& where) {
  constexpr std::uint64_t kWidest = 252;  // between groups, as the specification has it
  if (place.view >= views_.size())
    file_.fail(where, "it names bufferView " + std::to_string(place.view) + " of " + std::to_string(views_.size()) +
                          ", counted from 0; repair the file");
  const auto& [buffer, offset, length, given] = views_[place.view];
  const std::string view = "bufferView " + std::to_string(place.view);
  const std::uint64_t stride = given == 0 ? bytes : given;
  if (stride < bytes || stride > std::max(kWidest, bytes))
    file_.fail(view, "a byteStride of " + std::to_string(given) + " for elements of " + std::to_string(bytes) +
                         " bytes; repair the file");
  if (count == 0) return {"", stride};
  // No sum overflows: numbers of the file are below 2^53, and a product by the stride below 2^61.
  if (place.offset + (count - 1) * stride + bytes > length)
    file_.fail(where,
               "its numbers reach past the " + std::to_string(length) + " bytes of " + view + "; repair the file");
  if (buffer >= buffers_.size())
    file_.fail(view, "it names buffer " + std::to_string(buffer) + " of " + std::to_string(buffers_.size()) +
                         ", counted from 0; repair the file");
  if (offset + length > buffers_[buffer].length)
    file_.fail(view, "it reaches past the " + std::to_string(buffers_[buffer].length) + " bytes of buffer " +
                         std::to_string(buffer) + "; repair the file");
  return {read(buffer) + offset + place.offset, stride};
}

const char* GltfBuffers::read(std::uint64_t number) {
  Buffer& buffer = buffers_[number];
  if (buffer.bytes) return buffer.bytes;
  const std::string where = "buffer " + std::to_string(number);
  const std::string_view found = content(number, where);
  if (found.size() < buffer.length)
    file_.fail(where, "it has " + std::to_string(found.size()) + " bytes, where its byteLength promises " +
                          std::to_string(buffer.length) + "; it is cut off, get all of it");
  return buffer.bytes = found.data();
}

std::string_view GltfBuffers::content(std::uint64_t number, const std::string& where) {
  const auto given = buffers_[number].json.find("uri");
  if (!given) {
    if (number == 0 && binary_) return *binary_;
    file_.fail(where, "it has no uri, so it has no data; write the file again, without compression");
  }
  const std::string uri = given->text();
  if (is_data_uri(uri)) {
    auto data = data_of_uri(uri);
    if (!data)
      file_.fail(where,
                 "its data is no base64 of the form data:application/octet-stream;base64,AAAA; write the file again");
    return data_.emplace_back(std::move(*data));
  }
  const std::string path = companion_path(file_, where, uri);
  std::unique_ptr<FileView>& companion = companions_[path];
  if (!companion) {
    companion = open_companion(file_, where, path, longest_);
    companion_bytes_ += companion->size();
  }
  return companion->bytes();
}

namespace {

static_assert(std::endian::native == std::endian::little);

// As the specification has it: the ends of the type become -1 or 0, and 1.
template <class Stored>
double as_share(Stored value) {
  if constexpr (std::is_integral_v<Stored>)
    return std::max(double(value) / std::numeric_limits<Stored>::max(), -1.0);
  else
    return double(value);
}

}  // namespace

GltfNumbers::GltfNumbers(const FileView& file, const std::optional<JsonView>& accessors, GltfBuffers& buffers)
    : file_(file), buffers_(buffers) {
  if (!accessors) return;
  accessors_.reserve(accessors->size());
  accessors->each_element([&](const JsonView& json) { accessors_.push_back(json); });
}

const GltfNumbers::Accessor& GltfNumbers::find(std::uint64_t number) {
  if (number >= accessors_.size())
    file_.fail("", "it names accessor " + std::to_string(number) + " of " + std::to_string(accessors_.size()) +
                       ", counted from 0; repair the file");
  const auto known = read_.find(number);
  return known != read_.end() ? known->second : read_.emplace(number, accessor(number)).first->second;
}

// Of a componentType that glTF knows.
static StoredType stored_type(std::uint64_t code) { return static_cast<StoredType>(code - 5120); }

GltfNumbers::Accessor GltfNumbers::accessor(std::uint64_t number) {
  const JsonView& json = accessors_[number];
  constexpr std::array<std::pair<std::string_view, std::uint8_t>, 7> kWidths{
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT2", 4}, {"MAT3", 9}, {"MAT4", 16}}};
  const auto type = json.find("componentType"), width = json.find("type"), count = json.find("count");
  if (!type || !width || !count)
    file_.fail(name(number), "it lacks a type, a componentType or a count; repair the file");
  const auto found = std::ranges::find(kWidths, width->text(), &std::pair<std::string_view, std::uint8_t>::first);
  const std::uint64_t code = type->whole();
  if (found == kWidths.end() || code < 5120 || code > 5126 || code == 5124)
    file_.fail(name(number), "its type or componentType is none of glTF's; repair the file");
  Accessor read{{}, count->whole(), 0, stored_type(code), found->second, false};
  if (json.find("bufferView")) read.place = gltf_place(json);
  if (const auto normalized = json.find("normalized")) read.normalized = normalized->boolean();
  if (const auto given = json.find("sparse")) {
    sparse_.push_back(sparse(number, *given, read.count));
    read.sparse = sparse_.size();
  }
  return read;
}

GltfNumbers::Sparse GltfNumbers::sparse(std::uint64_t accessor, const JsonView& json, std::uint64_t count) const {
  const std::string where = name(accessor);
  const auto given = json.find("count"), indices = json.find("indices"), values = json.find("values");
  const auto type = indices ? indices->find("componentType") : std::nullopt;
  if (!given || !indices || !values || !type)
    file_.fail(where, "its sparse part lacks a count, indices with a componentType, or values; repair the file");
  const std::uint64_t number = type->whole();
  if (number != 5121 && number != 5123 && number != 5125)
    file_.fail(where, "its sparse indices are no unsigned integers; repair the file");
  const Sparse read{given->whole(), gltf_place(*indices), gltf_place(*values), stored_type(number)};
  if (read.count > count)
    file_.fail(where, std::to_string(read.count) + " sparse values for " + std::to_string(count) +
                          " elements; repair the file");
  return read;
}

void GltfNumbers::require(std::uint64_t number) {
  const Accessor& accessor = find(number);
  if (!accessor.place && accessor.sparse == 0)
    file_.fail(name(number), "it has no data; if it is compressed, write the file again without compression");
  const auto check = [&](const GltfPlace& place, StoredType type, std::uint64_t width, std::uint64_t count) {
    with_type(type, [&](auto value) { buffers_.rows(place, count, width * sizeof value, name(number)); });
  };
  if (accessor.place) check(*accessor.place, accessor.type, accessor.width, accessor.count);
  if (accessor.sparse == 0) return;
  const Sparse& sparse = sparse_[accessor.sparse - 1];
  check(sparse.indices, sparse.index_type, 1, sparse.count);
  check(sparse.values, accessor.type, accessor.width, sparse.count);
}

// Calls put(element, number within it, value as it is stored).
template <class Put>
void GltfNumbers::each_number(std::uint64_t number, const Put& put) {
  const Accessor& accessor = find(number);
  with_type(accessor.type, [&]<class Stored>(Stored value) {
    if (accessor.place) {
      const std::uint64_t bytes = accessor.width * sizeof value;
      const GltfRows rows = buffers_.rows(*accessor.place, accessor.count, bytes, name(number));
      for (std::uint64_t e = 0; e < accessor.count; ++e)
        for (std::size_t c = 0; c < accessor.width; ++c) {
          std::memcpy(&value, rows.first + e * rows.stride + c * sizeof value, sizeof value);
          put(e, c, value);
        }
    }
  });
  if (accessor.sparse != 0) each_sparse_number(number, put);
}

template <class Put>
void GltfNumbers::each_sparse_number(std::uint64_t number, const Put& put) {
  const Accessor& accessor = find(number);
  const Sparse& sparse = sparse_[accessor.sparse - 1];
  with_type(sparse.index_type, [&]<class Index>(Index index) {
    const GltfRows indices = buffers_.rows(sparse.indices, sparse.count, sizeof index, name(number));
    with_type(accessor.type, [&]<class Stored>(Stored value) {
      const GltfRows values = buffers_.rows(sparse.values, sparse.count, accessor.width * sizeof value, name(number));
      std::uint64_t least = 0;
      for (std::uint64_t e = 0; e < sparse.count; ++e) {
        std::memcpy(&index, indices.first + e * indices.stride, sizeof index);
        const auto at = static_cast<std::uint64_t>(index);
        if (at < least || at >= accessor.count)
          file_.fail(name(number), "its sparse indices do not rise, or reach " + std::to_string(at) +
                                       " where there are " + std::to_string(accessor.count) +
                                       " elements; repair the file");
        least = at + 1;
        for (std::size_t c = 0; c < accessor.width; ++c) {
          std::memcpy(&value, values.first + e * values.stride + c * sizeof value, sizeof value);
          put(at, c, value);
        }
      }
    });
  });
}

void GltfNumbers::read_positions(std::uint64_t number, std::vector<Vec3>& positions) {
  const Accessor& accessor = find(number);
  if (accessor.width != 3 || accessor.type == StoredType::uint32)
    file_.fail(name(number), "positions are VEC3 of float, byte or short; repair the file");
  const std::size_t first = positions.size();
  positions.resize(first + accessor.count);
  each_number(number, [&](std::uint64_t e, std::size_t c, auto value) {
    Vec3& position = positions[first + e];
    (c == 0 ? position.x : c == 1 ? position.y : position.z) = accessor.normalized ? as_share(value) : double(value);
  });
}

void GltfNumbers::read_indices(std::uint64_t number, std::vector<std::uint32_t>& indices) {
  const Accessor& accessor = find(number);
  const bool whole =
      accessor.type == StoredType::uint8 || accessor.type == StoredType::uint16 || accessor.type == StoredType::uint32;
  if (accessor.width != 1 || !whole || accessor.normalized)
    file_.fail(name(number), "indices are SCALAR of unsigned byte, short or int; repair the file");
  indices.assign(accessor.count, 0);
  each_number(number,
              [&](std::uint64_t e, std::size_t, auto value) { indices[e] = static_cast<std::uint32_t>(value); });
}

}  // namespace standoff
