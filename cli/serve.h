// SPDX-License-Identifier: Apache-2.0
// Pages that the program serves while it runs.
#pragma once

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "view/server/server.h"

namespace standoff::cli {

/// Where a page is served, and who opens it.
class ServeOptions {
 public:
  /// Adds --port, --no-browser and --keep.
  void add_to(CLI::App& verb);
  /// Throws Error{usage} if any was given where `why` nothing is served.
  void check_unused(const char* why) const;

  /// Serves what `handler` answers on this machine's loopback, prints the address, and opens it in a browser where
  /// there is a screen. Returns on Ctrl-C, and once nobody has looked at the page (`watch`) for some seconds. Errors:
  /// usage (the port), device.
  void serve(const Console& console, view::PageWatch& watch, view::Server::Handler handler) const;

 private:
  int port_ = 0;
  bool no_browser_ = false;
  bool keep_ = false;
  bool given_ = false;
};

}  // namespace standoff::cli
