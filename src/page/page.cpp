// SPDX-License-Identifier: Apache-2.0
#include "page/page.h"

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "core/guarded.h"
#include "core/number_text.h"
#include "files/atomic_file.h"
#include "files/deflate.h"
#include "render/image.h"
#include "standoff/color.h"
#include "standoff/error.h"
#include "standoff/page.h"

namespace standoff {

// What cmake/page.cmake makes of view/page.
extern const std::string_view kPageHtml;  // with a mark where each of the others goes
extern const std::string_view kPageStyle;
extern const std::string_view kPageScript;
extern const std::string_view kPageHashes;  // SHA-256 of style and script as two lines of hexadecimal digits

namespace page {
namespace {

constexpr std::string_view kReplacementBytes = "\xEF\xBF\xBD";  // U+FFFD

// How many bytes the UTF-8 character at the beginning has; 0: there is none.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t n) { return n < text.size() ? static_cast<unsigned char>(text[n]) : 0u; };
  const auto follows = [&](std::size_t n, unsigned least = 0x80, unsigned most = 0xBF) {
    return byte(n) >= least && byte(n) <= most;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first <= 0xDF) return follows(1) ? 2 : 0;
  // Not the longer forms of shorter characters, not the surrogates, nothing past U+10FFFF.
  if (first >= 0xE0 && first <= 0xEF)
    return follows(1, first == 0xE0 ? 0xA0 : 0x80, first == 0xED ? 0x9F : 0xBF) && follows(2) ? 3 : 0;
  if (first >= 0xF0 && first <= 0xF4)
    return follows(1, first == 0xF0 ? 0x90 : 0x80, first == 0xF4 ? 0x8F : 0xBF) && follows(2) && follows(3) ? 4 : 0;
  return 0;
}

std::string escaped(unsigned code) {
  std::array<char, 8> text{};
  std::snprintf(text.data(), text.size(), "\\u%04x", code);
  return text.data();
}

}  // namespace

std::string json_string(std::string_view text) {
  std::string json = "\"";
  while (!text.empty()) {
    const std::size_t bytes = character(text);
    const std::string_view one = bytes == 0 ? kReplacementBytes : text.substr(0, bytes);
    text.remove_prefix(std::max<std::size_t>(bytes, 1));
    const auto first = static_cast<unsigned char>(one[0]);
    if (one == "\xE2\x80\xA8" || one == "\xE2\x80\xA9")
      json += escaped(one[2] == '\xA8' ? 0x2028 : 0x2029);
    else if (first < 0x20 || first == 0x7F || std::string_view("\"\\<>&").find(one[0]) != std::string_view::npos)
      json += escaped(first);
    else
      json += one;
  }
  return json + '"';
}

namespace {
template <class Triple>
std::string triple_text(const Triple& v) {
  std::string text = "[";
  text += json_number(v.x) + ',' + json_number(v.y) + ',' + json_number(v.z) + ']';
  return text;
}
}  // namespace

std::string json_number(double value) { return std::isfinite(value) ? exact_text(value) : "null"; }
std::string json_number(std::int64_t value) { return std::to_string(value); }

std::string json_triple(Vec3 v) { return triple_text(v); }
std::string json_triple(Size3 v) { return triple_text(v); }

void append_base64(std::string& out, std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  out.reserve(out.size() + (bytes.size() + 2) / 3 * 4);
  for (std::size_t at = 0; at < bytes.size(); at += 3) {
    const std::string_view three = bytes.substr(at, 3);
    std::uint32_t bits = 0;
    for (std::size_t n = 0; n < 3; ++n)
      bits = bits << 8 | (n < three.size() ? static_cast<unsigned char>(three[n]) : 0u);
    for (std::size_t n = 0; n < 4; ++n) out += n <= three.size() ? kDigits[bits >> (18 - 6 * n) & 63] : '=';
  }
}

std::string packed_blob(JsonObject header, const std::vector<Section>& sections, int compression) {
  std::string list;
  for (const Section& section : sections)
    list += (list.empty() ? "[" : ",[") + json_string(section.name) + "," +
            json_number(static_cast<std::int64_t>(section.bytes.size())) + "]";
  const std::string text = header.add("sections", "[" + list + "]").text();
  std::string whole = "SOPG";
  for (int byte = 0; byte < 4; ++byte) whole += static_cast<char>(text.size() >> (8 * byte));
  whole += text;
  for (const Section& section : sections) whole += section.bytes;
  return compression == 0 ? whole : zlib_packed(whole, compression);
}

namespace {

// The policy names the hash of what may run; anything else that looks like a script, wherever it comes from, does not.
std::string source(std::string_view hexadecimal) {
  std::string bytes;
  for (std::size_t n = 0; n + 1 < hexadecimal.size(); n += 2)
    bytes += static_cast<char>(std::stoi(std::string(hexadecimal.substr(n, 2)), nullptr, 16));
  std::string text = "'sha256-";
  append_base64(text, bytes);
  return text + "'";
}

std::string policy(bool served) {
  return "default-src 'none'; script-src " + source(kPageHashes.substr(65, 64)) + "; style-src " +
         source(kPageHashes.substr(0, 64)) + "; img-src data: blob:" + (served ? "; connect-src 'self'" : "") +
         "; base-uri 'none'; form-action 'none'";
}

std::string escaped(std::string_view text) {
  std::string html;
  for (const char c : text) {
    if (c == '&')
      html += "&amp;";
    else if (c == '<')
      html += "&lt;";
    else if (c == '>')
      html += "&gt;";
    else
      html += c;
  }
  return html;
}

// The colors of a map at 33 even steps, as hexadecimal digits; JavaScript interpolates between them as color_of() does.
std::string colors(Colormap map) {
  constexpr int kSteps = 32;
  std::string text;
  for (int n = 0; n <= kSteps; ++n)
    for (const std::uint8_t channel : color_of(map, double(n) / kSteps)) {
      constexpr std::string_view kDigits = "0123456789abcdef";
      text += kDigits[channel >> 4];
      text += kDigits[channel & 15];
    }
  return json_string(text);
}

// The colors of bodies as CSS has them, in JSON.
std::string body_colors() {
  std::string list;
  for (const Color& color : kBodyColors)
    list += (list.empty() ? "[\"rgb(" : ",\"rgb(") + std::to_string(color[0]) + " " + std::to_string(color[1]) + " " +
            std::to_string(color[2]) + ")\"";
  return list + "]";
}

std::string config(std::string_view title, const PageOptions& options) {
  return JsonObject()
      .add("title", json_string(title))
      .add("source", options.served ? "\"server\"" : "\"embedded\"")
      .add("unit", json_string(options.unit))
      .add("up", json_string(axis_text(options.up.value_or(Axis::z))))
      .add("bodies", body_colors())
      .add("colormaps", JsonObject()
                            .add("viridis", colors(Colormap::viridis))
                            .add("diverging", colors(Colormap::diverging))
                            .add("thesis", colors(Colormap::thesis))
                            .text())
      .text();
}

}  // namespace

std::string html(std::string_view title, const PageOptions& options, const std::vector<std::string>& blobs) {
  std::size_t size = kPageHtml.size() + kPageStyle.size() + kPageScript.size() + 4096;
  for (const std::string& blob : blobs) size += blob.size() * 4 / 3 + 64;
  std::string page;
  page.reserve(size);
  // Marks are found in the template alone, never in what takes their place.
  for (std::string_view rest = kPageHtml; !rest.empty();) {
    const std::size_t mark = rest.find("<!--@");
    page += rest.substr(0, mark);
    if (mark == std::string_view::npos) break;
    const std::size_t end = rest.find("-->", mark);
    const std::string_view name = rest.substr(mark + 5, end - mark - 5);
    rest.remove_prefix(end + 3);
    if (name == "policy")
      page += "<meta http-equiv=\"Content-Security-Policy\" content=\"" + policy(options.served) + "\">";
    else if (name == "title")
      page += "<title>" + escaped(title) + "</title>";
    else if (name == "style")
      page.append("<style>").append(kPageStyle).append("</style>");
    else if (name == "config")
      page += "<script type=\"application/json\" id=\"config\">" + config(title, options) + "</script>";
    else if (name == "data")
      for (const std::string& blob : blobs) {
        page += "<script type=\"text/plain\" class=\"data\">";
        append_base64(page, blob);
        page += "</script>\n";
      }
    else if (name == "script")
      page.append("<script>").append(kPageScript).append("</script>");
    else
      throw Error(ErrorCode::internal, "view/page/page.html: no part is called '" + std::string(name) + "'");
  }
  return page;
}

}  // namespace page

namespace {

constexpr const char* kLessMemory =
    "show less in one page, allow it fewer samples or triangles, or provide more memory";

void expect_between(const char* name, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most)
    throw Error(ErrorCode::usage, std::string("PageOptions::") + name + " is " + std::to_string(value) +
                                      "; give a number from " + std::to_string(least) + " to " + std::to_string(most));
}

void check(const PageOptions& options) {
  expect_between("most_samples", options.most_samples, 512, std::int64_t{1} << 27);
  expect_between("most_triangles", options.most_triangles, 1000, 50'000'000);
  expect_between("proxy_triangles", options.proxy_triangles, 100, 50'000'000);
  expect_between("compression", options.compression, 0, 9);
  if (options.up && *options.up != Axis::x && *options.up != Axis::y && *options.up != Axis::z)
    throw Error(ErrorCode::usage, "PageOptions::up is no axis; give Axis::x, y or z");
}

std::string title_of(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options) {
  if (!options.title.empty()) return options.title;
  std::string title;
  const auto add = [&](const std::string& name) { title += (title.empty() ? "" : ", ") + name; };
  for (const PageMesh& mesh : meshes) add(mesh.name);
  for (const PageField& field : fields) add(field.name);
  return title.empty() ? "standoff" : title;
}

std::string made(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options,
                 std::vector<PageItem>* held) {
  check(options);
  std::vector<std::string> blobs;
  std::vector<PageItem> items;
  for (const PageMesh& mesh : meshes) blobs.push_back(page::mesh_blob(mesh, options, &items.emplace_back()));
  for (const PageField& field : fields) blobs.push_back(page::field_blob(field, options, &items.emplace_back()));
  PageOptions upright = options;
  if (!options.up) upright.up = up_axis(meshes, fields);
  std::string html = page::html(title_of(meshes, fields, options), upright, blobs);
  if (held) *held = std::move(items);
  return html;
}

}  // namespace

Axis up_axis(std::span<const PageMesh> meshes, std::span<const PageField> fields) try {
  for (const PageMesh& mesh : meshes)
    if (mesh.up) return *mesh.up;
  for (const PageField& field : fields)
    if (field.field && field.field->provenance().up) return *field.field->provenance().up;
  return meshes.empty() ? Axis::z : up_axis(meshes[0].mesh);
} catch (...) {
  throw_as_error("up_axis");
}

std::string make_page(std::span<const PageMesh> meshes, std::span<const PageField> fields, const PageOptions& options,
                      std::vector<PageItem>* held) {
  try {
    return made(meshes, fields, options, held);
  } catch (...) {
    throw_as_error("make_page", kLessMemory);
  }
}

void write_page(const std::filesystem::path& path, std::span<const PageMesh> meshes, std::span<const PageField> fields,
                const PageOptions& options, std::vector<PageItem>* held, Existing existing) {
  try {
    write_text(path, made(meshes, fields, options, held), existing);
  } catch (...) {
    throw_as_error("write_page", kLessMemory);
  }
}

std::string page_data(const PageMesh& mesh, const PageOptions& options, PageItem* held) {
  try {
    check(options);
    return page::mesh_blob(mesh, options, held);
  } catch (...) {
    throw_as_error("page_data", kLessMemory);
  }
}

std::string page_data(const PageField& field, const PageOptions& options, PageItem* held) {
  try {
    check(options);
    return page::field_blob(field, options, held);
  } catch (...) {
    throw_as_error("page_data", kLessMemory);
  }
}

}  // namespace standoff
