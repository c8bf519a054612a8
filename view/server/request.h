// SPDX-License-Identifier: Apache-2.0
// Requests: what one looks like, and who may come in. Any page in the same browser, and any user of the machine, can
// send requests to a port of loopback.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace standoff::view {

inline constexpr std::size_t kMostHeadBytes = 32 * 1024;
inline constexpr std::size_t kMostHeaders = 100;
inline constexpr std::size_t kMostParameters = 32;

/// What a client asks for.
struct Request {
  std::string method;  ///< "GET"
  std::string path;    ///< "/token/mesh": as sent, never decoded, for no path names a file
  std::vector<std::pair<std::string, std::string>> parameters;  ///< of the query, decoded; no name stands twice
  std::vector<std::pair<std::string, std::string>> headers;     ///< names in lower case, values without outer blanks
  std::uint64_t body_bytes = 0;                                 ///< Content-Length
  std::string body;                                             ///< read once the request may come in

  /// The value, or null.
  const std::string* header(std::string_view name) const;
  const std::string* parameter(std::string_view name) const;
  /// Whether the client asks that this be the connection's last request.
  bool closes() const;
};

/// What is wrong with a request: the answer's status, and a sentence.
struct Refusal {
  int status;
  std::string why;
};

/// The length of the head at the beginning of `bytes` with the empty line that ends it; nothing if that is still to
/// come.
std::optional<std::size_t> head_length(std::string_view bytes);

/// The request of a head, with its empty line; the body is left empty. `refusal` is set where it is malformed, or asks
/// for what this server does not do.
struct ParsedHead {
  Request request;
  std::optional<Refusal> refusal;
};
ParsedHead parse_head(std::string_view head);

/// "a=1&b=x%20y" as pairs. Nothing if a name stands twice or is empty, an escape is broken, or there are too many.
std::optional<std::vector<std::pair<std::string, std::string>>> parse_query(std::string_view query);

/// The secret in the address of a served page: 32 hexadecimal digits, 128 bits from the system's random numbers.
/// Errors: device (the system has none).
std::string random_token();

/// Whether both texts are the same. How long it takes depends on the length of `given` alone, so that nobody learns a
/// token by timing guesses.
bool same_token(std::string_view token, std::string_view given);

/// Whether a Host header names this machine's loopback: localhost, 127.0.0.1 or [::1], with any port or none, for a
/// forwarded port has another number. A page of a foreign name that resolves to 127.0.0.1 (DNS rebinding) fails here.
bool is_loopback_host(std::string_view host);

/// Looks at each request before anything is done for it, or any of its body is read.
class Gate {
 public:
  explicit Gate(std::string token) : token_(std::move(token)) {}
  const std::string& token() const { return token_; }

  /// Nothing if the request may come in; its path is then "/TOKEN/" and more. A foreign Host, a page of another origin,
  /// a wrong token are refused.
  std::optional<Refusal> check(const Request& request) const;
  /// The part of a request's path after "/TOKEN/".
  std::string_view route(const Request& request) const;

 private:
  std::string token_;
};

}  // namespace standoff::view
