// SPDX-License-Identifier: Apache-2.0
// A server for one page, on this machine's loopback alone. It answers what its handler answers, and has no files.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "view/server/reply.h"
#include "view/server/request.h"

namespace standoff::view {

struct ServerOptions {
  int port = 0;  ///< 0: a free one
  /// At once. One more, and the oldest connection that has not shown the token is closed, or the new one if all have.
  int connections = 32;
  std::uint64_t body_bytes = std::uint64_t{1} << 30;
  std::chrono::milliseconds idle{20'000};   ///< between requests of a connection that has shown the token
  std::chrono::milliseconds head{5'000};    ///< for a request's head, and to begin the first one
  std::chrono::milliseconds stall{10'000};  ///< between parts of a body
};

class Server {
 public:
  /// Called on a thread of the connection, for requests that may come in; `route` is the path after the token.
  using Handler = std::function<void(const Request& request, std::string_view route, Reply& reply)>;

  /// Listens on 127.0.0.1. Errors: usage (the port is taken), device (no sockets).
  Server(const ServerOptions& options, Handler handler);
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;
  /// Closes all connections and waits for their handlers, which see Reply::abandoned().
  ~Server();

  int port() const;
  /// "http://127.0.0.1:PORT/TOKEN/".
  std::string address() const;
  /// Accepts connections while `go_on()`, which is asked 20 times a second.
  void run(const std::function<bool()>& go_on);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace standoff::view
