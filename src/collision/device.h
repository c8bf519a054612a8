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

/// A row of the table of devices (src/backends/collision.cpp).
struct DeviceRow {
  Backend backend;
  bool (*available)();
  std::string (*device_name)(int device);
  void (*collide)(const CollideJob&);
  void (*sweep)(const SweepJob&);
};

/// The row for a batch of `count` queries; null for the CPU. Throws Error{device} if there is no such device.
const DeviceRow* find_device(Backend backend, std::size_t count);

}  // namespace standoff::collision

namespace standoff::cuda {  // src/collision/cuda
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
}  // namespace standoff::cuda

namespace standoff::emulated {  // the same on the emulated GPU
void collide(const collision::CollideJob& job);
void sweep(const collision::SweepJob& job);
}  // namespace standoff::emulated
