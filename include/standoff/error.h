// SPDX-License-Identifier: Apache-2.0
// The one exception type of standoff.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "standoff/export.h"

namespace standoff {

/// The kind of an error. The values are the exit codes of the `standoff` program.
enum class ErrorCode {
  internal = 1,       ///< a bug in standoff
  usage = 2,          ///< invalid arguments or options, or an invalid combination of them
  input = 3,          ///< a file or mesh that cannot be used as it is
  output = 4,         ///< a file that cannot be written
  limit = 5,          ///< more memory, or a larger size, than is allowed
  device = 6,         ///< a GPU that is absent or failed
  verify = 7,         ///< a field that does not match its mesh
  doubt = 8,          ///< a sign that is not certain, where certainty was asked for
  interrupted = 130,  ///< cancelled by the progress callback or a signal
};

/// The data in an error's message, for programs. Each member is set if it is known.
struct ErrorDetails {
  std::optional<std::int64_t> triangle = {};      ///< the first triangle of the mesh that cannot be used
  std::optional<std::int64_t> bytes_needed = {};  ///< ErrorCode::limit: how much memory is needed
  std::optional<std::int64_t> bytes_limit = {};   ///< ErrorCode::limit: the limit, or the memory there is
  std::string file = {};                          ///< the file that cannot be read or written; empty: none
  std::optional<std::int64_t> line = {};          ///< in that file, from 1
  std::optional<std::int64_t> byte = {};          ///< in that file, from 0
};

/// The only exception that functions of standoff throw; exceptions from the caller's callbacks pass unchanged. The
/// message says what is wrong, where and why, and what to do next. For files it has the form
/// `FILE:WHERE: what; what to do`.
class STANDOFF_API Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  Error(ErrorCode code, const std::string& message, ErrorDetails details)
      : std::runtime_error(message), code_(code), details_(std::make_shared<ErrorDetails>(std::move(details))) {}

  ErrorCode code() const noexcept { return code_; }
  const ErrorDetails& details() const noexcept {
    static const ErrorDetails none;
    return details_ ? *details_ : none;
  }

 private:
  ErrorCode code_;
  std::shared_ptr<const ErrorDetails> details_;  // shared, so that copies of an Error throw nothing
};

}  // namespace standoff
