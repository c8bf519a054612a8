// SPDX-License-Identifier: Apache-2.0
#include "view/server/request.h"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "standoff/error.h"

namespace standoff::view {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
// A character of a token, RFC 9110 5.6.2.
bool is_token(char c) {
  return is_letter(c) || is_digit(c) || std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}
bool all(std::string_view text, bool (*holds)(char)) { return std::ranges::all_of(text, holds); }
// Printable ASCII without the blank: what a target may hold.
bool is_visible(char c) { return c > ' ' && c < '\x7f'; }
// Bytes above ASCII too: other servers on this machine's name may have set such cookies.
bool is_value(char c) { return c == '\t' || (static_cast<unsigned char>(c) >= ' ' && c != '\x7f'); }

std::string lower(std::string_view text) {
  std::string lowered(text);
  for (char& c : lowered)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lowered;
}

std::string_view without_outer_blanks(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::optional<int> hex(char c) {
  if (is_digit(c)) return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return {};
}

std::optional<std::string> decoded(std::string_view text) {
  std::string plain;
  for (std::size_t n = 0; n < text.size(); ++n) {
    if (text[n] != '%') {
      plain += text[n] == '+' ? ' ' : text[n];
      continue;
    }
    if (n + 2 >= text.size()) return {};
    const auto high = hex(text[n + 1]), low = hex(text[n + 2]);
    if (!high || !low) return {};
    plain += static_cast<char>(*high * 16 + *low);
    n += 2;
  }
  return plain;
}

const std::string* find(const std::vector<std::pair<std::string, std::string>>& pairs, std::string_view name) {
  const auto found = std::ranges::find(pairs, name, [](const auto& pair) -> std::string_view { return pair.first; });
  return found == pairs.end() ? nullptr : &found->second;
}

std::optional<Refusal> read_request_line(std::string_view line, Request& request) {
  const auto first = line.find(' '), second = line.find(' ', first + 1);
  if (first == std::string_view::npos || second == std::string_view::npos) return Refusal{400, "no request line"};
  const auto method = line.substr(0, first), target = line.substr(first + 1, second - first - 1),
             version = line.substr(second + 1);
  if (method.empty() || !all(method, is_token)) return Refusal{400, "no method"};
  if (!target.starts_with('/') || !all(target, is_visible)) return Refusal{400, "no path"};
  if (version != "HTTP/1.1")
    return Refusal{version.starts_with("HTTP/") && all(version, is_visible) ? 505 : 400, "not HTTP/1.1"};
  const auto mark = target.find('?');
  auto parameters = parse_query(mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1));
  if (!parameters) return Refusal{400, "a malformed query"};
  request.method = method;
  request.path = target.substr(0, mark);
  request.parameters = std::move(*parameters);
  return {};
}

std::optional<Refusal> read_header(std::string_view line, Request& request) {
  const auto colon = line.find(':');
  // A name that begins with a blank would continue the line before it, which has long been forbidden.
  if (colon == std::string_view::npos || colon == 0 || !all(line.substr(0, colon), is_token))
    return Refusal{400, "a malformed header"};
  const auto value = without_outer_blanks(line.substr(colon + 1));
  if (!all(value, is_value)) return Refusal{400, "a malformed header"};
  if (request.headers.size() == kMostHeaders) return Refusal{431, "too many headers"};
  request.headers.emplace_back(lower(line.substr(0, colon)), value);
  return {};
}

// How long the body is. One header alone may say so: with two that differ, a request can be hidden in the body of
// another.
std::optional<Refusal> read_body_length(Request& request) {
  for (const char* once : {"host", "content-length", "origin"})
    if (std::ranges::count(request.headers, once, [](const auto& header) { return header.first; }) > 1)
      return Refusal{400, std::string("two headers ") + once};
  if (request.header("transfer-encoding")) return Refusal{501, "a body in chunks; send its Content-Length"};
  const std::string* length = request.header("content-length");
  if (!length) return {};
  const char* const end = length->data() + length->size();
  const auto read = std::from_chars(length->data(), end, request.body_bytes);
  if (length->empty() || !all(*length, is_digit) || read.ec != std::errc() || read.ptr != end)
    return Refusal{400, "a malformed Content-Length"};
  return {};
}

}  // namespace

const std::string* Request::header(std::string_view name) const { return find(headers, name); }
// Options with commas between them; the header may stand more than once. RFC 9110 7.6.1.
bool Request::closes() const {
  for (const auto& [name, value] : headers) {
    if (name != "connection") continue;
    for (std::string_view rest = value; !rest.empty();) {
      const auto comma = std::min(rest.find(','), rest.size());
      if (lower(without_outer_blanks(rest.substr(0, comma))) == "close") return true;
      rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
  }
  return false;
}
const std::string* Request::parameter(std::string_view name) const { return find(parameters, name); }

std::optional<std::size_t> head_length(std::string_view bytes) {
  const auto end = bytes.find("\r\n\r\n");
  return end == std::string_view::npos ? std::nullopt : std::optional(end + 4);
}

ParsedHead parse_head(std::string_view head) {
  ParsedHead parsed;
  bool first = true;
  while (!parsed.refusal) {
    const auto end = head.find("\r\n");
    if (end == std::string_view::npos) {
      parsed.refusal = Refusal{400, "no empty line"};
      break;
    }
    const auto line = head.substr(0, end);
    head.remove_prefix(end + 2);
    if (line.empty() && !first) break;
    parsed.refusal = first ? read_request_line(line, parsed.request) : read_header(line, parsed.request);
    first = false;
  }
  if (!parsed.refusal) parsed.refusal = read_body_length(parsed.request);
  return parsed;
}

std::optional<std::vector<std::pair<std::string, std::string>>> parse_query(std::string_view query) {
  std::vector<std::pair<std::string, std::string>> parameters;
  while (!query.empty()) {
    const auto end = std::min(query.find('&'), query.size());
    const auto part = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    const auto equals = std::min(part.find('='), part.size());
    auto name = decoded(part.substr(0, equals)), value = decoded(part.substr(std::min(equals + 1, part.size())));
    if (!name || !value || name->empty() || find(parameters, *name) || parameters.size() == kMostParameters) return {};
    parameters.emplace_back(std::move(*name), std::move(*value));
  }
  return parameters;
}

std::string random_token() {
  std::array<unsigned char, 16> bytes;
  // Not std::random_device: the standard allows it to be a fixed sequence.
  if (::getentropy(bytes.data(), bytes.size()) != 0)
    throw Error(ErrorCode::device, "the system gives no random numbers; write a page with -o instead");
  constexpr char kDigits[] = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) (token += kDigits[byte >> 4]) += kDigits[byte & 15];
  return token;
}

bool same_token(std::string_view token, std::string_view given) {
  // Volatile, or the compiler could leave the loop at the first difference.
  volatile unsigned char differs = token.size() != given.size() || token.empty();
  for (std::size_t n = 0; n < given.size(); ++n) {
    const char expected = token.empty() ? '\0' : token[n % token.size()];
    differs = static_cast<unsigned char>(differs | static_cast<unsigned char>(expected ^ given[n]));
  }
  return differs == 0;
}

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
