// SPDX-License-Identifier: Apache-2.0
// The seam between batches of queries and the devices that answer them: jobs and answers, the table of devices, and the
// functions that answer a batch on CUDA and on its emulation.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "collision/body/body.h"
#include "collision/body/kernel_data.h"
#include "collision/conservative_advancement.h"

namespace standoff::collision {

/// A pose of b. QueryPair computes its bounds on the host, so they equal the CPU's.
struct PoseQuery {
  DoubleTransform of_b;      ///< b in the world
  FloatTransform transform;  ///< from the probe's coordinates to the target's, both relative to their middles
  float limit;  ///< if spheres or boxes are farther apart than this, so are their triangles than the margin
};

enum class DeviceVerdict : std::uint32_t {
  free,
  hit,
  undecided,  ///< rounding may hide an intersecting pair, and no pair intersects for certain
  overflow,   ///< the stack of nodes is too short
};

struct PoseAnswer {
  DeviceVerdict verdict;
  std::uint32_t of_target, of_probe;  ///< for a hit: the BVH indices of two triangles that intersect
};

/// The largest stack of nodes that devices have, for each of the two BVHs.
inline constexpr int kDeviceStack = 256;

/// Poses to be decided. A verdict of free or hit equals the CPU's.
struct CollideJob {
  const BodyData &target, &probe;
  bool target_is_b;      ///< else it is a
  DoubleTransform of_a;  ///< a in the world
  double margin;
  std::span<const PoseQuery> queries;
  std::span<PoseAnswer> answers;  ///< one per query
  int device;
  int stack = kDeviceStack;  ///< the most nodes on the stack; tests take fewer to make it overflow
};

/// A motion of b.
struct SweepQuery {
  RelativeMotion motion;
  float keep;  ///< the distance left after every step
};

struct SweepAnswer {
  DeviceVerdict verdict;  ///< free for certain, undecided, or overflow
};

struct SweepJob {
  const BodyData &target, &probe;
  std::span<const SweepQuery> queries;
  std::span<SweepAnswer> answers;  ///< one per query
  int device;
  int stack = kDeviceStack;
};

/// A pose of b.
struct DistanceQuery {
  DoubleTransform of_b;       ///< b in the world
  DoubleTransform to_target;  ///< from the probe's coordinates to the target's, both relative to their middles
  FloatTransform transform;   ///< the same in single precision
  double pose_slack;          ///< as in QueryPair
};

/// The nearest pair of triangles of a pose.
struct DistanceAnswer {
  DeviceVerdict verdict;               ///< free, undecided (the bodies may intersect), or overflow
  std::uint32_t of_target, of_probe;   ///< BVH indices; kNoTriangle if no pair is nearer than the limit
  std::uint32_t ties;                  ///< pairs about as near (kTies), at least; exact up to kWorthAProof
  std::uint32_t node_pairs, measured;  ///< the work: pairs of nodes opened or looked at, pairs of triangles measured
};

/// The sizes of lists. The answers do not depend on them, but for overflows; tests take fewer.
struct DistanceLists {
  int stack = kDeviceStack;
  int turn = 64;                                  ///< node pairs that a warp opens before it hands over what waits
  std::uint32_t handed = std::uint32_t{1} << 18;  ///< node pairs that wait for other warps
  std::uint32_t found = std::uint32_t{1} << 16;   ///< pairs that warps have found, besides one for each pose
};

struct DistanceJob {
  const BodyData &target, &probe;
  bool target_is_b, probe_is_small;
  DoubleTransform of_a;
  double limit;
  std::span<const DistanceQuery> queries;
  std::span<DistanceAnswer> answers;  ///< one per query
  int device;
  DistanceLists lists;
};

/// A row of the table of devices (src/backends/collision.cpp).
struct DeviceRow {
  Backend backend;
  bool (*available)();
  std::string (*device_name)(int device);
  void (*collide)(const CollideJob&);
  void (*sweep)(const SweepJob&);
  void (*distance)(const DistanceJob&);
};

/// The row for a batch of `count` queries; null for the CPU. Throws Error{device} if there is no such device.
const DeviceRow* find_device(Backend backend, std::size_t count);

}  // namespace standoff::collision

namespace standoff::cuda {  // src/collision/cuda
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
void distance(const collision::DistanceJob& job);
}  // namespace standoff::cuda

namespace standoff::emulated {  // the same on the emulated GPU
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
void distance(const collision::DistanceJob& job);
}  // namespace standoff::emulated
