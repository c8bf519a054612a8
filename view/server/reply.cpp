// SPDX-License-Identifier: Apache-2.0
#include "view/server/reply.h"

#include <array>
#include <charconv>

namespace standoff::view {
namespace {

constexpr std::chrono::seconds kStall{20};

const char* phrase(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 422:
      return "Unprocessable Content";
    case 431:
      return "Request Header Fields Too Large";
    case 501:
      return "Not Implemented";
    case 503:
      return "Service Unavailable";
    case 505:
      return "HTTP Version Not Supported";
    default:
      return "Internal Server Error";
  }
}

// - Nothing is stored: the next program on this port is another one, and fields are large.
// - The page has all its scripts and styles inside, and talks to its own server alone. Its address is in no Referer.
// - Notebooks show it in a frame, and they are served from other ports of loopback, or are VS Code's own pages. Nobody
//   else may frame it; and whoever does needs the token.
// - Other origins can neither read it, nor embed it, nor get hold of its window.
constexpr char kHeaders[] =
    "Cache-Control: no-store\r\n"
    "Content-Security-Policy: default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
    "img-src data: blob:; worker-src blob:; connect-src 'self' data: blob:; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'self' http://localhost:* http://127.0.0.1:* vscode-webview:\r\n"
    "Cross-Origin-Opener-Policy: same-origin\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Permissions-Policy: camera=(), geolocation=(), microphone=()\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "X-Content-Type-Options: nosniff\r\n";

std::string head(int status, const char* type) {
  return "HTTP/1.1 " + std::to_string(status) + ' ' + phrase(status) + "\r\nContent-Type: " + type + "\r\n" + kHeaders;
}

}  // namespace

bool Reply::write(std::string_view bytes) {
  if (!connection_.write(bytes, kStall)) keeps_ = false;
  return keeps_;
}

void Reply::send(int status, const char* type, std::string_view body) {
  sent_ = true;
  const std::string begin = head(status, type) + "Content-Length: " + std::to_string(body.size()) +
                            (closes_ ? "\r\nConnection: close\r\n\r\n" : "\r\n\r\n");
  // Short answers in one packet.
  if (body.size() > 4096) {
    if (connection_.write(begin, kStall)) write(body);
  } else {
    write(begin + std::string(body));
  }
}

void Reply::refuse(const Refusal& refusal) { send(refusal.status, "text/plain; charset=utf-8", refusal.why + "\n"); }

bool Reply::begin_stream(const char* type) {
  sent_ = streams_ = true;
  return write(head(200, type) + "Transfer-Encoding: chunked\r\n" + (closes_ ? "Connection: close\r\n\r\n" : "\r\n"));
}

bool Reply::part(std::string_view bytes) {
  if (stopping_() || connection_.closed()) keeps_ = false;
  if (!keeps_ || bytes.empty()) return keeps_;
  std::array<char, 20> length;
  const auto end = std::to_chars(length.begin(), length.end(), bytes.size(), 16).ptr;
  std::string chunk(length.begin(), end);
  (((chunk += "\r\n") += bytes) += "\r\n");
  return write(chunk);
}

void Reply::end_stream() {
  if (streams_ && keeps_) write("0\r\n\r\n");
  streams_ = false;
}

}  // namespace standoff::view
