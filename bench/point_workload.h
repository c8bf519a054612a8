// SPDX-License-Identifier: Apache-2.0
// The workload of the drivers of points: distances of many points from a mesh, with the same options for all drivers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "standoff/mesh.h"

namespace standoff::bench {

/// The places of points.
enum class PointSet {
  box,   ///< uniformly random in the mesh's box, grown to 1.5 times its sides about its centre
  near,  ///< random points of the surface, displaced by up to 1 % of the box's longest side in random directions
  far,   ///< 3 to 30 times the box's longest side from its centre, as many for each factor of 2, in random directions
};

/// The points of a set, the same on every machine and for every driver.
std::vector<Vec3> make_points(const Mesh& mesh, PointSet set, std::int64_t count, std::uint64_t seed);

/// One job: the distances of these points.
struct PointWorkload {
  std::string source;  ///< the scene's name or the file's
  Mesh mesh;
  std::vector<Vec3> points;
  int threads = 2;
  int repeats = 5;  ///< calls in this process; their median counts
  std::filesystem::path answers;

  nlohmann::json describe() const;
  /// Writes the distances that a driver found as raw doubles, if --answers asks for it.
  void save_answers(std::span<const double> distances) const;
};

/// Adds the options of a workload of points to a driver's command line; `make` builds it after parsing.
class PointOptions {
 public:
  explicit PointOptions(CLI::App& app);
  /// With --save it also writes the mesh and the points for peers in other languages, as raw little-endian arrays:
  /// vertices.f64, triangles.u32, points.f64. Throws the library's errors: usage and input.
  PointWorkload make() const;

 private:
  std::string mesh_, scene_, answers_, save_;
  std::int64_t triangles_ = 0, count_ = 1'000'000;
  std::uint64_t seed_ = 1;
  PointSet set_ = PointSet::box;
  int threads_ = 2, repeats_ = 5;
};

}  // namespace standoff::bench
