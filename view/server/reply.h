// SPDX-License-Identifier: Apache-2.0
// What a request is answered with: one answer, or a stream that lasts.
#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "view/server/connection.h"
#include "view/server/request.h"

namespace standoff::view {

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

}  // namespace standoff::view
