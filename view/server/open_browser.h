// SPDX-License-Identifier: Apache-2.0
// Shows an address to the user's browser.
#pragma once

#include <filesystem>
#include <string>

namespace standoff::view {

/// A page that sends a browser on to an address. It goes into a file that its owner alone can read: the address itself
/// must be no argument of a program, for every user of the machine can read those.
std::string signpost(const std::string& address);

/// Whether there is a screen here that a browser could open on.
bool has_screen();

/// Starts the program that shows files to the user (xdg-open; `open` on macOS), without a shell, and does not wait.
/// False where there is none.
bool open_browser(const std::filesystem::path& file);

}  // namespace standoff::view
