// SPDX-License-Identifier: Apache-2.0
// A server for one page, on this machine's loopback alone. It answers what its handler answers, and has no files. With
// it: whether somebody still looks at the page, and how the user's browser is shown its address.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "view/server/request.h"

namespace standoff::view {

/// One client: bytes in and out with deadlines, so that a slow or silent one holds a thread for seconds only.
class Connection {
 public:
  using Clock = std::chrono::steady_clock;

  /// For an open socket, which the caller closes. Nothing here blocks past its deadline.
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

/// The answer to one request: whole, or as a stream of parts.
class Reply {
 public:
  /// `stopping` says when a stream has to end because the server does.
  Reply(Connection& connection, std::function<bool()> stopping)
      : connection_(connection), stopping_(std::move(stopping)) {}

  /// One answer. `type` is the media type.
  void send(int status, const char* type, std::string_view body);
  /// A refusal, as a line of text.
  void refuse(const Refusal& refusal);
  /// The first part of a stream: the headers. Then parts, each one a chunk; false once nobody listens or the server
  /// stops.
  bool begin_stream(const char* type);
  bool part(std::string_view bytes);
  /// Ends a stream, after which the connection can be used again.
  void end_stream();
  /// Whether the answer has no reader any more.
  bool abandoned() const { return stopping_() || connection_.closed(); }

  bool sent() const { return sent_; }
  /// Whether another request may follow: everything of this one was read and written, and nobody wants to close.
  bool keeps() const { return keeps_ && !closes_; }
  void close_after() { closes_ = true; }

 private:
  bool write(std::string_view bytes);

  Connection& connection_;
  std::function<bool()> stopping_;
  bool sent_ = false;
  bool streams_ = false;
  bool keeps_ = true;    // all was written so far
  bool closes_ = false;  // the answer is the connection's last one
};

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

/// Whether somebody still looks at the page. A page keeps a stream open for as long as it is shown; while it is loaded
/// again, no stream is open for a moment.
class PageWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// While one lives, a page is open.
  class Open {
   public:
    explicit Open(PageWatch& watch) : watch_(watch) { watch_.count(1); }
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;
    ~Open() { watch_.count(-1); }

   private:
    PageWatch& watch_;
  };

  /// Whether a page was open, and none has been for `grace`.
  bool closed_for(std::chrono::milliseconds grace) const {
    const std::lock_guard lock(mutex_);
    return seen_ && open_ == 0 && Clock::now() - last_ >= grace;
  }
  bool seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  void count(int change) {
    const std::lock_guard lock(mutex_);
    open_ += change;
    seen_ = true;
    last_ = Clock::now();
  }

  mutable std::mutex mutex_;
  int open_ = 0;
  bool seen_ = false;
  Clock::time_point last_;
};

/// A page that sends a browser on to an address. It goes into a file that its owner alone can read: the address itself
/// must be no argument of a program, for every user of the machine can read those.
std::string signpost(const std::string& address);

/// Whether there is a screen here that a browser could open on.
bool has_screen();

/// Starts the program that shows files to the user (xdg-open; `open` on macOS), without a shell, and does not wait.
/// False where there is none.
bool open_browser(const std::filesystem::path& file);

}  // namespace standoff::view
