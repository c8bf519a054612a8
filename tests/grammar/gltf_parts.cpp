// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/gltf_parts.h"

#include <algorithm>

#include "tests/grammar/hostile.h"

namespace standoff::grammar {
namespace {

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (at + k < bytes.size() ? static_cast<unsigned char>(bytes[at + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += at + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

Json counted(Choices& c, std::uint64_t value) { return Json::literal(whole(c, static_cast<std::int64_t>(value))); }

}  // namespace

GltfData::GltfData(Choices& c, bool binary) : c_(c), binary_(binary), buffers_(1 + c.below(3)) {}

Json GltfData::positions(const std::vector<Vec3>& points) {
  std::vector<std::string> elements;
  Vec3 low = points[0], high = low;
  for (const Vec3& p : points) {
    std::string element;
    for (const double x : {p.x, p.y, p.z}) element += raw(stored(c_, static_cast<float>(x)));
    elements.push_back(element);
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  constexpr std::uint32_t kFloat = 5126;
  const Json number = accessor(elements, kFloat, "VEC3", true);
  Json& made = accessors_.items().back();
  for (const auto& [name, at] : {std::pair("min", low), std::pair("max", high)}) {
    made[name] = Json::list();
    for (const double x : {at.x, at.y, at.z}) made[name].push(Json::literal(real(c_, x)));
  }
  return number;
}

Json GltfData::indices(const std::vector<std::uint32_t>& numbers, std::size_t points) {
  constexpr std::uint32_t kByte = 5121, kShort = 5123, kInt = 5125;
  std::uint32_t component = c_.one_in(3) ? kInt : points < 250 && c_.one_in(2) ? kByte : kShort;
  std::vector<std::string> elements;
  for (const std::uint32_t number : numbers)
    elements.push_back(component == kByte    ? raw(stored(c_, static_cast<std::uint8_t>(number)))
                       : component == kShort ? raw(stored(c_, static_cast<std::uint16_t>(number)))
                                             : raw(stored(c_, number)));
  return accessor(elements, component, "SCALAR", false);
}

// A view of its own, some bytes into the buffer, some bytes before the first number and between them.
Json GltfData::accessor(const std::vector<std::string>& elements, std::uint32_t component, const char* type,
                        bool may_stride) {
  const std::size_t which = c_.below(static_cast<std::uint32_t>(buffers_.size())), width = elements[0].size();
  std::string& buffer = buffers_[which];
  buffer.resize((buffer.size() + 3) / 4 * 4 + 4 * c_.below(3));
  if (c_.trick()) buffer += "x";
  const std::size_t begin = buffer.size(), before = c_.one_in(4) ? 4 * (1 + c_.below(4)) : 0;
  const bool strides = may_stride && c_.one_in(3);
  const std::size_t stride = strides ? (width + 3) / 4 * 4 + 4 * c_.below(4) : width;
  buffer.append(before, '\xee');
  for (std::size_t n = 0; n < elements.size(); ++n) {
    buffer += elements[n];
    if (n + 1 < elements.size()) buffer.append(stride - width, '\xdd');
  }
  Json view, made;
  view["buffer"] = counted(c_, which);
  if (begin > 0 || c_.one_in(2)) view["byteOffset"] = counted(c_, begin);
  view["byteLength"] = counted(c_, buffer.size() - begin);
  if (strides) view["byteStride"] = counted(c_, stride);
  made["bufferView"] = counted(c_, views_.size());
  if (before > 0 || c_.one_in(2)) made["byteOffset"] = counted(c_, before);
  made["componentType"] = c_.trick() ? Json(5118 + c_.below(14)) : Json(component);
  made["count"] = counted(c_, elements.size());
  constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4", "VEC5", ""};
  made["type"] = c_.trick() ? c_.pick(kTypes) : type;
  if (c_.trick()) {
    made["sparse"]["count"] = counted(c_, 1);
    made["sparse"]["indices"]["bufferView"] = counted(c_, 0);
    made["sparse"]["values"]["bufferView"] = counted(c_, 0);
  }
  if (c_.trick()) made["normalized"] = Json::literal("true");
  views_.push(std::move(view));
  accessors_.push(std::move(made));
  return counted(c_, accessors_.size() - 1);
}

void GltfData::finish(Json& json, File& file) {
  Json list = Json::list();
  for (std::size_t n = 0; n < buffers_.size(); ++n) {
    const std::string& bytes = buffers_[n];
    Json buffer;
    buffer["byteLength"] = counted(c_, std::max<std::size_t>(bytes.size(), 1));
    const std::string content = bytes.empty() ? std::string(1, '\0') : bytes;
    if (binary_ && n == 0) {
      chunk_ = content;
      if (c_.trick()) buffer["uri"] = bad_path(c_);
    } else if (c_.trick()) {
      buffer["uri"] = bad_path(c_);
    } else if (c_.one_in(4)) {
      const std::string name = "data" + std::to_string(n) + ".bin";
      buffer["uri"] = name;
      file.beside.emplace_back(name, content);
    } else {
      constexpr const char* kHeads[] = {"data:application/octet-stream;base64,",
                                        "data:application/gltf-buffer;base64,"};
      std::string uri = word(c_, c_.pick(kHeads)) + base64(content);
      if (c_.trick()) damage(c_, uri);
      buffer["uri"] = uri;
    }
    list.push(std::move(buffer));
  }
  json["buffers"] = std::move(list);
  json["bufferViews"] = std::move(views_);
  json["accessors"] = std::move(accessors_);
}

std::string make_glb_bytes(Choices& c, std::string json, const std::string& data) {
  const auto chunk = [&](std::string bytes, const std::string& type, char padding) {
    if (!c.trick()) bytes.resize((bytes.size() + 3) / 4 * 4, padding);
    return raw(stored(c, static_cast<std::uint32_t>(bytes.size()))) + word(c, type) + bytes;
  };
  std::string body = chunk(std::move(json), "JSON", ' ');
  if (c.trick()) body += chunk("{}", "JSON", ' ');
  if (!c.trick()) body += chunk(data, std::string("BIN\0", 4), '\0');
  if (c.one_in(8)) body += raw(std::uint32_t{4}) + "EXTRdata";
  return word(c, "glTF") + raw(stored(c, std::uint32_t{2})) +
         raw(stored(c, static_cast<std::uint32_t>(12 + body.size()))) + body;
}

void hang(Json& json, Choices& c) {
  Json& nodes = json["nodes"];
  auto next = static_cast<std::uint32_t>(nodes.size());
  json["scenes"].items().back()["nodes"].push(next);
  const std::uint32_t kind = c.below(4), count = kind == 1 ? 10 + c.below(60) : c.many();
  for (std::uint32_t n = 0; n < count; ++n, ++next) {
    Json node, children = Json::list();
    const bool last = n + 1 == count;
    if (kind == 0 && !last) children.push(next + 1);
    if (kind == 1 && !last) children.push(next + 1), children.push(next + 1);
    if (kind == 2) children.push(last ? next + 1 - count : next + 1);
    if (kind == 3 && n == 0)
      for (std::uint32_t k = 0; k < count; ++k) children.push(next + 1);
    if (last) node["mesh"] = 0;
    if (children.size() > 0) node["children"] = std::move(children);
    nodes.push(std::move(node));
    if (kind == 3 && n == 1) return;
  }
}

}  // namespace standoff::grammar
