// SPDX-License-Identifier: Apache-2.0
#include "view/server/open_browser.h"

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include <cstdlib>

extern char** environ;

namespace standoff::view {
namespace {

#ifdef __APPLE__
constexpr const char* kProgram = "open";
#else
constexpr const char* kProgram = "xdg-open";
#endif

}  // namespace

std::string signpost(const std::string& address) {
  return "<!doctype html><meta charset=utf-8><title>standoff</title><meta http-equiv=refresh content=\"0;url=" +
         address + "\"><a href=\"" + address + "\">the page of standoff</a>\n";
}

bool has_screen() {
#ifdef __APPLE__
  return std::getenv("SSH_CONNECTION") == nullptr;
#else
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value) return true;
  return false;
#endif
}

bool open_browser(const std::filesystem::path& file) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  if (::posix_spawn_file_actions_init(&actions) != 0) return false;
  if (::posix_spawnattr_init(&attributes) != 0) {
    ::posix_spawn_file_actions_destroy(&actions);
    return false;
  }
  // What a browser says is not for this terminal.
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  // A process group of its own: Ctrl-C here is not meant for the browser.
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  std::string path = file.string(), name = kProgram;
  char* arguments[] = {name.data(), path.data(), nullptr};
  pid_t child = 0;
  const bool started = ::posix_spawnp(&child, kProgram, &actions, &attributes, arguments, environ) == 0;
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return started;
}

}  // namespace standoff::view
