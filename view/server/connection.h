// SPDX-License-Identifier: Apache-2.0
// One client: bytes in and out with deadlines, so that a slow or silent one holds a thread for seconds only.
#pragma once

#include <chrono>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "view/server/request.h"

namespace standoff::view {

class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// Of an open socket, which the caller closes. Nothing here blocks past its deadline.
  explicit Connection(int socket) : socket_(socket) {}
  int socket() const { return socket_; }

  /// The head of the next request: its first byte within `idle`, all of it within `whole` from then on. What went wrong
  /// otherwise: a refusal with status 0 where the client is gone, or never spoke, and there is nobody to answer.
  struct Head {
    std::string text;
    std::optional<Refusal> refusal;
  };
  Head read_head(std::chrono::milliseconds idle, std::chrono::milliseconds whole);
  /// `bytes` bytes of body; nothing if they do not come. The client may take `stall` between two parts, and sends a
  /// mebibyte a second at the least.
  std::optional<std::string> read_body(std::size_t bytes, std::chrono::milliseconds stall);
  /// False once the client is gone, or takes nothing for `stall`.
  bool write(std::string_view bytes, std::chrono::milliseconds stall);
  /// Whether the client has closed its end. Looks, and does not wait.
  bool closed() const;
  /// Ends the answer. What the client still sends is read and thrown away for a moment: closing before would tell it
  /// of an error in place of the answer.
  void finish();

 private:
  enum class Read { some, end, late };
  Read read_some(Clock::time_point deadline);

  int socket_;
  std::string ahead_;  // read, and not asked for yet
};

}  // namespace standoff::view
