// SPDX-License-Identifier: Apache-2.0
// The common options of the drivers of surfaces.
#pragma once

#include <functional>
#include <string>

#include "driver.h"
#include "workload.h"

namespace standoff::bench {

struct IsoSettings {
  double at = 0;     ///< the value on the surface, in samples
  std::string save;  ///< a folder, or nothing
};

/// For use in main.
inline int run_iso_driver(const char* description, const char* name, int argc, char** argv,
                          const std::function<nlohmann::json(const Workload&, const IsoSettings&)>& run) {
  CLI::App app(description, name);
  const WorkloadOptions options(app);
  IsoSettings settings;
  app.add_option("--at", settings.at, "the value on the surface, in samples");
  app.add_option("--save", settings.save, "write the surface, and standoff the field too, into this folder");
  return run_driver(app, options, argc, argv, [&](const Workload& work) { return run(work, settings); });
}

}  // namespace standoff::bench
