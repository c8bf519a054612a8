// SPDX-License-Identifier: Apache-2.0
#include "cli/serve.h"

#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <optional>

#include "cli/options.h"
#include "cli/parse.h"
#include "cli/process.h"
#include "cli/text.h"
#include "files/atomic_file.h"
#include "view/server/server.h"

namespace standoff::cli {
namespace {

// The longest gap between closing a page and loading it again; browsers need about a second.
constexpr std::chrono::seconds kGrace{4};

// Says how to reach the page over SSH, if the user is on another machine.
std::string forwarding(int port) {
  if (!std::getenv("SSH_CONNECTION")) return {};
  char host[256] = "";
  if (::gethostname(host, sizeof host - 1) != 0 || !*host) return {};
  const std::string number = std::to_string(port);
  return "over SSH: on your own machine run  ssh -N -L " + number + ":127.0.0.1:" + number + " " + one_line(host) +
         "  and open that address there";
}

}  // namespace

void ServeOptions::add_to(CLI::App& verb) {
  add_parsed(verb, {"--port", "N", "of the address on 127.0.0.1 (default: any that is free)", "Server"},
             [this](S o, S t) {
               port_ = static_cast<int>(parse_count(o, t, 0, 65535));
               given_ = true;
             });
  const auto flag = [&](const char* name, bool& value, const char* help) {
    verb.add_flag_callback(
            name, [this, &value] { value = given_ = true; }, help)
        ->group("Server");
  };
  flag("--no-browser", no_browser_, "only print the address");
  flag("--keep", keep_, "go on when the page is closed, until Ctrl-C");
}

void ServeOptions::check_unused(const char* why) const {
  if (given_)
    throw Error(ErrorCode::usage, std::string("--port, --no-browser and --keep: ") + why + "; leave them out");
}

void ServeOptions::serve(const Console& console, view::PageWatch& watch, view::Server::Handler handler) const {
  const Cancellable cancellable;
  view::Server server({.port = port_}, std::move(handler));
  const std::string address = server.address();
  std::optional<TempFile> signpost;
  bool opened = false;
  if (!no_browser_ && view::has_screen()) {
    signpost.emplace(".html", view::signpost(address));
    opened = view::open_browser(signpost->path());
  }
  print(address + "\n");
  if (const std::string how = forwarding(server.port()); !how.empty()) console.say(how);
  console.say(std::string(opened ? "opened in your browser" : "open this address in a browser") +
              (keep_ ? "; Ctrl-C ends it" : "; closing the page, or Ctrl-C, ends it"));
  server.run([&] {
    if (watch.seen()) signpost.reset();  // the browser has read it
    return !interrupted() && (keep_ || !watch.closed_for(kGrace));
  });
}

}  // namespace standoff::cli
