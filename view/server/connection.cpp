// SPDX-License-Identifier: Apache-2.0
// One client: bytes in and out with deadlines, and answers.

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>

#include "view/server/server.h"

namespace standoff::view {
namespace {

using std::chrono::milliseconds;

// Whether the socket is ready before the deadline.
bool wait(int socket, short events, Connection::Clock::time_point deadline) {
  for (;;) {
    const auto left = std::chrono::ceil<milliseconds>(deadline - Connection::Clock::now()).count();
    if (left <= 0) return false;
    pollfd asked{socket, events, 0};
    const int ready = ::poll(&asked, 1, static_cast<int>(std::min<std::int64_t>(left, 60'000)));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return false;
  }
}

}  // namespace

Connection::Read Connection::read_some(Clock::time_point deadline) {
  std::array<char, 64 * 1024> part;
  for (;;) {
    const auto got = ::recv(socket_, part.data(), part.size(), MSG_DONTWAIT);
    if (got > 0) {
      ahead_.append(part.data(), static_cast<std::size_t>(got));
      return Read::some;
    }
    if (got == 0) return Read::end;
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return Read::end;
    if (!wait(socket_, POLLIN, deadline)) return Read::late;
  }
}

Connection::Head Connection::read_head(milliseconds idle, milliseconds whole) {
  auto deadline = Clock::now() + (ahead_.empty() ? idle : whole);
  for (;;) {
    if (const auto length = head_length(ahead_); length && *length <= kMostHeadBytes) {
      Head head{ahead_.substr(0, *length), {}};
      ahead_.erase(0, *length);
      return head;
    }
    if (ahead_.size() > kMostHeadBytes) return {{}, Refusal{431, "the head is too long"}};
    const bool silent = ahead_.empty();
    switch (read_some(deadline)) {
      case Read::some:
        if (silent) deadline = Clock::now() + whole;
        break;
      case Read::end:
        return {{}, Refusal{0, "closed"}};
      case Read::late:
        return {{}, silent ? Refusal{0, "silent"} : Refusal{408, "the request takes too long"}};
    }
  }
}

std::optional<std::string> Connection::read_body(std::size_t bytes, milliseconds stall) {
  const auto last = Clock::now() + stall + std::chrono::seconds(bytes >> 20);
  while (ahead_.size() < bytes)
    if (read_some(std::min(last, Clock::now() + stall)) != Read::some) return {};
  std::string body = ahead_.substr(0, bytes);
  ahead_.erase(0, bytes);
  return body;
}

bool Connection::write(std::string_view bytes, milliseconds stall) {
  while (!bytes.empty()) {
    const auto sent = ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(sent));
      continue;
    }
    if (errno == EINTR) continue;
    if (errno != EAGAIN && errno != EWOULDBLOCK) return false;
    if (!wait(socket_, POLLOUT, Clock::now() + stall)) return false;
  }
  return true;
}

bool Connection::closed() const {
  char next;
  const auto got = ::recv(socket_, &next, 1, MSG_DONTWAIT | MSG_PEEK);
  return got == 0 || (got < 0 && errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
}

void Connection::finish() {
  ::shutdown(socket_, SHUT_WR);
  const auto deadline = Clock::now() + milliseconds(500);
  for (int part = 0; part < 64 && read_some(deadline) == Read::some; ++part) ahead_.clear();
}

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
