// SPDX-License-Identifier: Apache-2.0
#include "view/server/gate.h"

#include <algorithm>

#include "view/server/token.h"

namespace standoff::view {
namespace {

// The first folder of a path, which is the token, if there is another slash after it.
std::string_view first_folder(std::string_view path) {
  const auto end = path.find('/', 1);
  return end == std::string_view::npos ? std::string_view() : path.substr(1, end - 1);
}

}  // namespace

bool is_loopback_host(std::string_view host) {
  for (const std::string_view name : {"localhost", "127.0.0.1", "[::1]"}) {
    if (!host.starts_with(name)) continue;
    const std::string_view port = host.substr(name.size());
    if (port.empty()) return true;
    const bool digits = std::ranges::all_of(port.substr(1), [](char c) { return c >= '0' && c <= '9'; });
    if (port[0] == ':' && port.size() > 1 && port.size() <= 6 && digits) return true;
  }
  return false;
}

std::optional<Refusal> Gate::check(const Request& request) const {
  const std::string* const host = request.header("host");
  if (!host) return Refusal{400, "no Host"};
  if (!is_loopback_host(*host)) return Refusal{403, "this server answers to localhost and 127.0.0.1 alone"};
  // A page's own requests have its address as their origin. Browsers send none with what a user opens.
  const std::string* const origin = request.header("origin");
  if (origin && *origin != "http://" + *host) return Refusal{403, "this server answers its own page alone"};
  // Newer browsers also say so of images, scripts and frames of other pages, which have no Origin. A link may be
  // followed from anywhere: it needs the token.
  const std::string* const site = request.header("sec-fetch-site");
  const std::string* const mode = request.header("sec-fetch-mode");
  const bool own = !site || *site == "same-origin" || *site == "none";
  if (!own && !(request.method == "GET" && mode && *mode == "navigate"))
    return Refusal{403, "this server answers its own page alone"};
  if (!same_token(token_, first_folder(request.path)))
    return Refusal{403, "this address lacks the key; open the one that standoff printed"};
  return {};
}

std::string_view Gate::route(const Request& request) const {
  return std::string_view(request.path).substr(token_.size() + 2);
}

}  // namespace standoff::view
