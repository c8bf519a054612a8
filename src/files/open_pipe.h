// SPDX-License-Identifier: Apache-2.0
// Named pipes that may have nobody at their other end: waiting for one can be stopped, and is said.
#pragma once

#include <filesystem>
#include <string>

#include "files/descriptor.h"

namespace standoff {

class ProgressMeter;

/// Opens what is read from front to back. Of a pipe it waits until something comes through it, or its writer has gone;
/// meanwhile `waiting`, if there is one, may stop it (Error{interrupted}). As ::open: below zero with errno.
Descriptor open_to_read(const std::filesystem::path& path, ProgressMeter* waiting = nullptr);

/// Opens a pipe or device that is there, which the caller calls `shown`. Of a pipe it waits until somebody reads it. As
/// ::open.
Descriptor open_to_write(const std::filesystem::path& path, const std::filesystem::path& shown);

/// What gets a sentence, "FILE: ..", once somebody has waited for a pipe for a second. None by default: a library does
/// not speak. Set it before any thread opens a file.
void set_pipe_notice(void (*notice)(const std::string& sentence)) noexcept;

}  // namespace standoff
