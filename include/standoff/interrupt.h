// What a signal handler needs to leave nothing half-written behind.
#pragma once

namespace standoff {

/// Removes the temporary files of all writes in progress in this process. Async-signal-safe: call it from a handler of
/// SIGINT, SIGTERM or SIGHUP that ends the process next. Targets are never touched: a file that was being replaced
/// keeps its old content. Writes that go on afterwards may fail.
void remove_unfinished_files() noexcept;

}  // namespace standoff
