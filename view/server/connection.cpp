// SPDX-License-Identifier: Apache-2.0
#include "view/server/connection.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

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

}  // namespace standoff::view
