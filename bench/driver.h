// SPDX-License-Identifier: Apache-2.0
// The common main function of all drivers.
#pragma once

#include <exception>
#include <iostream>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace standoff::bench {

/// Parses, runs `measure(options.make())` and prints the JSON line it returns; errors go to stderr. For use in main.
template <class Options, class Measure>
int run_driver(CLI::App& app, const Options& options, int argc, char** argv, const Measure& measure) {
  CLI11_PARSE(app, argc, argv);
  try {
    const nlohmann::json line = measure(options.make());
    std::cout << line.dump() << std::endl;
    return 0;
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return 1;
  }
}

}  // namespace standoff::bench
