// SPDX-License-Identifier: Apache-2.0
// Files with one pose or motion on each line.
#pragma once

#include <string>
#include <vector>

#include "standoff/collision.h"

namespace standoff::cli {

/// The poses in a file; "-" is the standard input. A line holds the numbers of one pose as --pose takes them, with
/// commas between them; what follows a # is a comment, and empty lines are left out. A file without a pose has
/// none. Errors: input, as `FILE:LINE: what`.
std::vector<Pose> read_poses(const std::string& name);
/// The same with the numbers of two poses on a line: where the motion begins, and where it ends.
std::vector<RigidMotion> read_motions(const std::string& name, Vec3 center);

}  // namespace standoff::cli
