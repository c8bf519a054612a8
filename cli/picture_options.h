// SPDX-License-Identifier: Apache-2.0
// The options of pictures, which several verbs draw.
#pragma once

#include <vector>

#include <CLI/CLI.hpp>

#include "standoff/picture.h"

namespace standoff::cli {

inline constexpr const char* kPictureGroup = "Picture";

/// Adds --size, --camera, --up, --parallel, --samples, --background and --no-legend, with the defaults that `options`
/// has; returns them.
std::vector<const CLI::Option*> add_picture_options(CLI::App& verb, PictureOptions& options);

}  // namespace standoff::cli
