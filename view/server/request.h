// SPDX-License-Identifier: Apache-2.0
// The head of an HTTP/1.1 request, as strict as a server for one page may be: what a browser does not send is an
// error, not a guess.
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

}  // namespace standoff::view
