// SPDX-License-Identifier: Apache-2.0
// Moving bodies among resting bodies: the thesis's fly in the labyrinth (docs/thesis.md).
// A demonstration of sweeps.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "standoff/collision.h"
#include "standoff/execution.h"
#include "standoff/existing.h"
#include "standoff/mesh.h"
#include "standoff/pose.h"
#include "standoff/progress.h"

namespace standoff::fly {

/// How contacts of a moving body with resting ones are found.
enum class FlightMode {
  sweep,   ///< each step is a sweep: bodies pass through nothing, at any speed
  thesis,  ///< Algorithm 2 tests the pose after the step: fast bodies pass through
};

/// What a moving body does on a contact.
enum class OnContact {
  turn_back,  ///< reverses its direction, as in the thesis, scattered by `scatter_rad`
  reflect,    ///< is reflected by the surface, like light; thesis mode has no normals, so the body turns back
};

struct FlightOptions {
  FlightMode mode = FlightMode::sweep;
  OnContact on_contact = OnContact::turn_back;
  double speed = 0.02;       ///< world units per step
  double scatter_rad = 0.5;  ///< after a contact the direction is turned at random by up to this angle, 0 to pi
  Box bounds = {};       ///< moving bodies turn back where the centre of their box would leave this; empty: no limit
  double tolerance = 0;  ///< sweep mode: as in SweepOptions
  double thickness = 2;  ///< thesis mode: the thickness of both fields
  double minimum = 2;    ///< thesis mode: the parameter e of minimum_grid() in standoff/thesis.h
  double threshold = 0;  ///< thesis mode: the threshold of the sum; 0: the larger spacing of the two grids
  /// Thesis mode: a moving body's field is computed anew at each step, on the minimum grid of its box there, by
  /// Algorithm 1; else its field is computed once and moves with it.
  bool recompute = false;
  Backend backend = Backend::automatic;  ///< thesis mode: where it tests and recomputes; automatic: on the CPU
  int device = 0;                        ///< thesis mode: as in Execution
  std::uint64_t seed = 1;
  int threads = 0;    ///< as in Execution
  bool check = true;  ///< count wall crossings by the independent check
  ProgressCallback progress = {};
};

/// One moving body. It keeps its orientation.
struct Flier {
  Pose pose;
  Vec3 direction;  ///< unit length
  std::int64_t collisions = 0;
  std::int64_t turns = 0;      ///< how often it turned back because it would have left the bounds
  std::int64_t crossings = 0;  ///< steps in which it crossed a resting surface, by the independent check
  std::uint64_t seed = 0;      ///< the state of its random numbers; changes with each number drawn
};

/// Resting bodies and any number of moving bodies. The moving ones have the same shape and ignore each other.
class World {
 public:
  /// Errors: usage (options), input.
  World(const Body& flier, const FlightOptions& options);
  World(const World&) = delete;
  World& operator=(const World&) = delete;
  ~World();

  /// Adds a resting body. Errors: usage (pose).
  void add(const Body& body, const Pose& pose = {});
  /// Adds a moving body at a random pose inside `box` that touches no resting body, rotated about the vertical, with a
  /// random direction. The random numbers of the n-th body depend only on n and the seed. Errors: input if 10,000 tries
  /// find no free pose.
  void add_flier(const Box& box);
  /// Adds a moving body as it is, such as one of another world. Where it starts is not looked at: one that touches a
  /// resting body may collide at each step. Errors: usage (pose, direction).
  void restore_flier(const Flier& flier);
  /// Takes away all moving bodies but the first `count`.
  void keep_fliers(std::size_t count);
  std::span<const Flier> fliers() const;

  const FlightOptions& options() const;
  /// Other options from the next run on. Bodies stay where they are. Thesis mode computes its fields anew, because
  /// their grids depend on the speed. Errors: usage; limit (memory); nothing has changed then.
  void set_options(const FlightOptions& options);

  /// out[n] is how far the middle of the n-th moving body's box is from the surface of the nearest resting body, exact,
  /// world units; infinite if there is none. The first call prepares the resting meshes (standoff/points.h). Errors:
  /// usage (another length than that of fliers()), limit (memory).
  void wall_distances(std::span<double> out);

  /// Runs `steps` steps (0 or more) of all moving bodies in parallel; the result does not depend on the number of
  /// threads. `visit(flier, step, pose)`, if given, is called when a flier starts, turns and ends. The calls for one
  /// flier come in order; calls for different fliers may come from different threads. If `visit` throws, the run ends
  /// and the exception reaches the caller unchanged.
  using Visit = std::function<void(std::size_t flier, std::int64_t step, const Pose& pose)>;
  void run(std::int64_t steps, const Visit& visit = {});

  /// The grid of the n-th resting body: in thesis mode that of its field, in sweep mode that of its body.
  Grid grid(std::size_t n) const;
  /// The grid of the moving bodies' field: in thesis mode that of Algorithm 2, where it is recomputed that of the first
  /// moving body, or of one at the origin; in sweep mode that of the body.
  Grid flier_grid() const;
  /// Where contacts are found: in thesis mode where Algorithm 2 runs, in sweep mode on the CPU, which has no name.
  Backend backend() const;
  std::string device_name() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A corner of a path.
struct PathPoint {
  std::int64_t flier, step;
  Vec3 point;
};

/// Writes paths, sorted by flier and step, as .csv (flier,step,x,y,z) or as .ply with vertices and edges; the file
/// appears whole or not at all. Errors: output, usage (another extension).
void write_path(const std::filesystem::path& path, std::span<const PathPoint> points,
                Existing existing = Existing::replace);

}  // namespace standoff::fly
