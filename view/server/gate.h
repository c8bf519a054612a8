// SPDX-License-Identifier: Apache-2.0
// Who may come in. Any page in the same browser, and any user of the machine, can send requests to a port of loopback.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "view/server/request.h"

namespace standoff::view {

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
