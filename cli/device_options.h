// Where work runs: options that several verbs have.
#pragma once

#include <CLI/CLI.hpp>

#include "standoff/compute.h"

namespace standoff::cli {

/// Adds --device.
CLI::Option* add_device(CLI::App& verb, const char* group, Backend& backend, int& device);
/// Adds -j.
CLI::Option* add_threads(CLI::App& verb, const char* group, int& threads);

}  // namespace standoff::cli
