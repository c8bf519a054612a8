// SPDX-License-Identifier: Apache-2.0
// A glTF of one triangle, of which a test changes parts.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>

namespace standoff {

template <class Value>
std::string little_endian(std::initializer_list<Value> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * sizeof(Value)};
}

inline std::string percent_encoded(std::string_view bytes) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text;
  for (const unsigned char c : bytes) text += {'%', kDigits[c / 16], kDigits[c % 16]};
  return text;
}

/// Members as JSON texts. The buffer holds (0,0,0), (1,0,0), (0,1,0) as floats unless it is changed.
struct GltfDocument {
  std::string version = "\"2.0\"";
  std::string nodes = R"([{"mesh":0}])", scene = "[0]";
  std::string primitive = R"({"attributes":{"POSITION":0}})";
  std::string accessors = R"({"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"})";
  std::string views = R"({"buffer":0,"byteLength":36})";
  std::string data = little_endian<float>({0, 0, 0, 1, 0, 0, 0, 1, 0});
  std::string uri = "";   // in place of the data
  std::string root = "";  // more members of the whole

  std::string text() const {
    return R"({"asset":{"version":)" + version + R"(},"scene":0,"scenes":[{"nodes":)" + scene + R"(}],"nodes":)" +
           nodes + R"(,"meshes":[{"primitives":[)" + primitive + R"(]}],"accessors":[)" + accessors +
           R"(],"bufferViews":[)" + views + R"(],"buffers":[{"byteLength":)" + std::to_string(data.size()) +
           R"(,"uri":")" + (uri.empty() ? "data:application/octet-stream," + percent_encoded(data) : uri) + "\"}]" +
           root + "}";
  }

  /// The same as a GLB, whose binary part the buffer is.
  std::string binary() const {
    const std::string parts = text();
    const auto uri_begin = parts.rfind(R"(,"uri":")"), uri_end = parts.find('"', uri_begin + 8) + 1;
    std::string json = parts.substr(0, uri_begin) + parts.substr(uri_end), bytes = data;
    json.resize((json.size() + 3) / 4 * 4, ' ');
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const auto number = [](std::size_t n) { return little_endian({static_cast<std::uint32_t>(n)}); };
    return "glTF" + number(2) + number(28 + json.size() + bytes.size()) + number(json.size()) + "JSON" + json +
           number(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
};

}  // namespace standoff
