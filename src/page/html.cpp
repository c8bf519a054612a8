// SPDX-License-Identifier: Apache-2.0
#include "page/html.h"

#include <array>

#include "page/base64.h"
#include "page/json_text.h"
#include "render/image.h"
#include "standoff/error.h"

// What cmake/page.cmake makes of view/page.
namespace standoff {
extern const std::string_view kPageHtml;  // with a mark where each of the others goes
extern const std::string_view kPageStyle;
extern const std::string_view kPageScript;
extern const std::string_view kPageHashes;  // SHA-256 of style and script as two lines of hexadecimal digits
}  // namespace standoff

namespace standoff::page {
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

std::string config(std::string_view title, const PageOptions& options) {
  constexpr std::array kAxes{"x", "y", "z"};
  return JsonObject()
      .add("title", json_string(title))
      .add("source", options.served ? "\"server\"" : "\"embedded\"")
      .add("unit", json_string(options.unit))
      .add("up", json_string(kAxes[static_cast<std::size_t>(options.up)]))
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

}  // namespace standoff::page
