// SPDX-License-Identifier: Apache-2.0
// The workload of all drivers: a mesh on a grid, with the same command line options for all drivers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff::bench {

/// One job: fill this grid with this mesh's distances.
struct Workload {
  std::string source;  ///< the scene's name or the file's
  Mesh mesh;           ///< world units; already stretched if the options say so
  Grid grid;
  double thickness = 0;  ///< world units; infinite for a full field
  int threads = 2;
  int repeats = 5;     ///< calls in this process: the first is cold, the others warm
  double enough = 0;   ///< no further call after so many seconds; 0: all of them
  bool check = false;  ///< compare with another way of computing the same field, after the timing
  std::string values;  ///< if not empty, the file that gets the values after the timing: raw floats, x fastest

  bool full() const;  ///< whether every sample's distance is asked for
  /// The common part of the JSON lines of all drivers.
  nlohmann::json describe() const;
};

/// Adds the options of a workload to a driver's command line; `make` builds it after parsing.
class WorkloadOptions {
 public:
  explicit WorkloadOptions(CLI::App& app);
  /// Throws the library's errors: usage and input.
  Workload make() const;

 private:
  std::string mesh_, scene_, values_;
  std::int64_t triangles_ = 0, samples_ = 256, cube_ = 0;
  std::vector<double> extent_;
  std::vector<std::int64_t> size_;
  double thickness_ = 2, enough_ = 0;
  std::optional<double> margin_, scale_, stray_;
  int threads_ = 2, repeats_ = 5;
  bool full_ = false, check_ = false;
};

}  // namespace standoff::bench
