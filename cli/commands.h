// SPDX-License-Identifier: Apache-2.0
// The verbs: each adds itself to the program and runs when it is named. One file per verb.
#pragma once

#include <CLI/CLI.hpp>

namespace standoff::cli {

void add_compute(CLI::App& program);
void add_info(CLI::App& program);
void add_slice(CLI::App& program);
void add_view(CLI::App& program);
void add_render(CLI::App& program);
void add_verify(CLI::App& program);
void add_generate(CLI::App& program);
void add_convert(CLI::App& program);
void add_iso(CLI::App& program);
void add_devices(CLI::App& program);
void add_crossings(CLI::App& program);
void add_voxels(CLI::App& program);
void add_build(CLI::App& program);
void add_collide(CLI::App& program);
void add_distance(CLI::App& program);
void add_sweep(CLI::App& program);
void add_fly(CLI::App& program);
void add_points(CLI::App& program);

}  // namespace standoff::cli
