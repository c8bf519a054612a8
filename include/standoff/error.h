// The one exception type of standoff.
#pragma once

#include <stdexcept>
#include <string>

namespace standoff {

/// What kind of thing went wrong. The values are the exit codes of the `standoff` program.
enum class ErrorCode {
  internal = 1,       ///< a bug in standoff
  usage = 2,          ///< arguments or options that make no sense, alone or together
  input = 3,          ///< a file or mesh that cannot be used as it is
  output = 4,         ///< a file that cannot be written
  limit = 5,          ///< more memory, or a larger size, than is allowed
  device = 6,         ///< a device that is absent or failed
  verify = 7,         ///< a field that does not match its mesh
  interrupted = 130,  ///< cancelled by the progress callback or a signal
};

/// Thrown by every function of standoff that fails, and nothing else is, but for what the caller's own callbacks throw.
/// The message says what, where, why and what to do next; for files it reads `FILE:WHERE: what; what to do`.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
  ErrorCode code() const noexcept { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace standoff
