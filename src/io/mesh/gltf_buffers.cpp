// SPDX-License-Identifier: Apache-2.0
#include "io/mesh/gltf_buffers.h"

#include <algorithm>
#include <utility>

#include "io/mesh/companion_file.h"
#include "io/mesh/uri.h"

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

}  // namespace standoff
