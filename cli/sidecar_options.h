// SPDX-License-Identifier: Apache-2.0
// What compute --with stores beside the distances: nearest triangles and sidecars.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "cli/files.h"
#include "standoff/compute.h"
#include "standoff/sidecars.h"

namespace standoff::cli {

/// The sidecars that compute --with makes.
inline constexpr std::array kSidecarKinds{SidecarKind::closest_point, SidecarKind::barycentric, SidecarKind::feature,
                                          SidecarKind::gradient};

class SidecarOptions {
 public:
  /// Takes names with commas between them. Errors: usage.
  void add(const std::string& option, const std::string& text);
  bool empty() const { return !nearest_ && kinds_.empty(); }
  /// Throws Error{usage} where the output's format has no place for them.
  void check(const FileOutput& output) const;
  /// Asks the computation for what they are made of.
  void prepare(ComputeOptions& options) const { options.nearest = nearest_ || !kinds_.empty(); }
  /// The bytes of those that are not the field's own, for each sample of a stored tile.
  std::int64_t bytes_per_sample() const;
  /// Makes them, and removes nearest triangles from the field unless they are to be stored.
  std::vector<Sidecar> make(MeshView mesh, DistanceField& field, const Execution& execution,
                            const ProgressCallback& progress) const;

 private:
  bool nearest_ = false;
  std::vector<SidecarKind> kinds_;
};

}  // namespace standoff::cli
