// SPDX-License-Identifier: Apache-2.0
// The common part of the kernels of queries: a body in device memory, the stack of a warp, its traversal of
// the target's BVH, and the function that runs a kernel over a batch of queries from host memory, a warp per query.
#pragma once

#include <algorithm>
#include <span>

#include "collision/device.h"
#include "geometry/triple.h"
#include "gpu/devices.h"
#include "gpu/platform.cuh"

namespace standoff::STANDOFF_PLATFORM {

using collision::kLanes;

// The most levels of a BVH: sixteen to the eighth power is the most triangles.
inline constexpr int kMostLevels = 8;

/// A body as kernels read it. Pointers are to device memory.
struct DeviceBodyView {
  collision::FieldView field;
  const collision::Sphere16* spheres[kMostLevels];  ///< by level, as in BodyBvh
  const Boxes16* boxes[kMostLevels];
  const collision::Obb16* oriented[kMostLevels + 1];  ///< none at 0
  const collision::Triangle16* triangles;
  const double* corners;  ///< nine numbers per triangle, by index in the BVH
  Triple<double> middle;
  std::uint32_t triangle_count;
  int top;  ///< the top level

  /// The number of nodes of a level.
  STANDOFF_DEVICE std::uint32_t nodes_of(int level) const {
    const int bits = 4 * (level + 1);
    return static_cast<std::uint32_t>((std::uint64_t{triangle_count} + (std::uint64_t{1} << bits) - 1) >> bits);
  }
};

/// Loads the corners of a triangle, by its index in the BVH, in the body's own coordinates.
STANDOFF_DEVICE void load_corners(const DeviceBodyView& body, std::uint32_t index, Triple<double> (&corner)[3]) {
  const double* const at = body.corners + 9 * std::int64_t{index};
  for (int k = 0; k < 3; ++k) corner[k] = {at[3 * k], at[3 * k + 1], at[3 * k + 2]};
}

class DeviceBody : public gpu::DeviceCopy {
 public:
  explicit DeviceBody(const collision::BodyData& data) {
    static_assert(sizeof(standoff::Corners) == 9 * sizeof(double));
    gpu::Workspace measure(nullptr);
    lay_out(data, measure, [](auto*, const auto*, std::int64_t) {});
    memory_ = Memory(measure.used());
    gpu::Workspace arrays(memory_.as<void>());
    lay_out(data, arrays, [](auto* to, const auto* from, std::int64_t bytes) { copy_in(to, from, bytes); });
  }
  const DeviceBodyView& view() const { return view_; }

 private:
  template <class Copy>
  void lay_out(const collision::BodyData& data, gpu::Workspace& arrays, Copy copy) {
    const auto put = [&]<class Values>(const Values& values) {
      using Value = std::remove_cv_t<typename Values::value_type>;
      const auto count = static_cast<std::int64_t>(values.size());
      Value* const to = arrays.take<Value>(count);
      copy(to, values.data(), count * static_cast<std::int64_t>(sizeof(Value)));
      return to;
    };
    view_.field = data.view;
    view_.field.slots = put(data.field.slots);
    view_.field.samples = put(data.field.samples);
    view_.field.coarse = put(data.field.coarse);
    view_.top = data.bvh.top();
    for (int level = 0; level <= view_.top; ++level) {
      view_.spheres[level] = put(data.bvh.spheres[level]);
      view_.boxes[level] = put(data.bvh.tree.level(level));
      view_.oriented[level + 1] = put(data.bvh.oriented[static_cast<std::size_t>(level) + 1]);
    }
    view_.triangles = put(data.bvh.triangles);
    view_.corners = reinterpret_cast<const double*>(put(data.corners));
    view_.middle = {data.middle.x, data.middle.y, data.middle.z};
    view_.triangle_count = static_cast<std::uint32_t>(data.bvh.order().size());
  }

  Memory memory_;
  DeviceBodyView view_{};
};

/// The copy of the body on the current device.
inline std::shared_ptr<const DeviceBody> device_body_of(const collision::BodyData& data, Backend backend, int device) {
  return std::static_pointer_cast<const DeviceBody>(
      data.device_bodies.get(backend, device, [&] { return std::make_shared<DeviceBody>(data); }));
}

// A packet of sixteen nodes in one word: the low bits hold its index, which is below 2^28 for 2^32 triangles, the high
// bits its level.
inline constexpr int kLevelShift = 28;
inline constexpr std::uint32_t kNoPacket = 0xffffffffu;
STANDOFF_DEVICE std::uint32_t packet_word(int level, std::uint32_t packet) {
  return static_cast<std::uint32_t>(level) << kLevelShift | packet;
}
STANDOFF_DEVICE int level_of(std::uint32_t word) { return static_cast<int>(word >> kLevelShift); }
STANDOFF_DEVICE std::uint32_t packet_of(std::uint32_t word) { return word & ((1u << kLevelShift) - 1); }

inline constexpr std::uint32_t kWarp = 0xffffffffu;
STANDOFF_DEVICE std::uint32_t lane_in_warp() { return threadIdx.x % 32; }
STANDOFF_DEVICE std::uint32_t lanes_below(std::uint32_t lane) { return (1u << lane) - 1; }

/// A packet and the time at which its nodes start.
struct TimedPacket {
  double time;
  std::uint32_t word;
};
STANDOFF_DEVICE std::uint32_t word_of(std::uint32_t entry) { return entry; }
STANDOFF_DEVICE std::uint32_t word_of(const TimedPacket& entry) { return entry.word; }

/// The stack of packets that a warp still has to visit, in shared memory. All lanes hold the same count, and must make
/// every call together.
template <class Entry>
class NodeStack {
 public:
  /// `entries`: shared memory for `capacity` entries.
  STANDOFF_DEVICE NodeStack(Entry* entries, int capacity, Entry first)
      : entries_(entries), capacity_(capacity), count_(1) {
    __syncwarp();
    if (lane_in_warp() == 0) entries_[0] = first;
    __syncwarp();
  }
  STANDOFF_DEVICE bool empty() const { return count_ == 0; }
  STANDOFF_DEVICE int count() const { return count_; }
  STANDOFF_DEVICE const Entry& from_top(int n) const { return entries_[count_ - 1 - n]; }
  /// Takes entries off that all lanes have read.
  STANDOFF_DEVICE void drop(int count) {
    count_ -= count;
    __syncwarp();
  }
  STANDOFF_DEVICE int top_level() const { return level_of(word_of(entries_[count_ - 1])); }

  /// Pops two packets, one for each half of the warp. The second half gets `none` if there is only one, or if the level
  /// of the second is below `least_level`.
  STANDOFF_DEVICE Entry take(int least_level, Entry none) {
    const bool two = count_ > 1 && level_of(word_of(entries_[count_ - 2])) >= least_level;
    const bool second = lane_in_warp() >= kLanes;
    const Entry entry = !second ? entries_[count_ - 1] : two ? entries_[count_ - 2] : none;
    count_ -= two ? 2 : 1;
    __syncwarp();  // all lanes have read before any writes
    return entry;
  }

  /// Pushes the entries of some lanes, the highest rank (0 to their number less one) on top. If they do not fit, pushes
  /// none and returns false.
  STANDOFF_DEVICE bool put(std::uint32_t lanes, int rank, Entry entry) {
    const int more = __popc(lanes);
    if (count_ + more > capacity_) return false;
    if (lanes >> lane_in_warp() & 1) entries_[count_ + rank] = entry;
    count_ += more;
    __syncwarp();
    return true;
  }

 private:
  Entry* entries_;
  int capacity_, count_;
};

/// The number of lanes, of some, with a larger key, or with an equal key and a higher number. `keys`: shared memory for
/// 32 keys.
template <class Key>
STANDOFF_DEVICE int larger_keys(std::uint32_t lanes, Key key, Key* keys) {
  const std::uint32_t lane = lane_in_warp();
  keys[lane] = key;
  __syncwarp();
  int larger = 0;
  for (std::uint32_t m = 0; m < 32; ++m)
    if (lanes >> m & 1) larger += keys[m] > key || (keys[m] == key && m > lane);
  __syncwarp();
  return larger;
}

/// A box: the low sides, then the high ones.
struct FlatBox {
  float side[6];
};
STANDOFF_DEVICE bool overlap(const FlatBox& a, const FlatBox& b) {
  bool overlapping = true;
  for (int axis = 0; axis < 3; ++axis)
    overlapping = overlapping && a.side[axis] <= b.side[3 + axis] && a.side[3 + axis] >= b.side[axis];
  return overlapping;
}
STANDOFF_DEVICE FlatBox box_in(const Boxes16& boxes, std::uint32_t n) {
  FlatBox box;
  for (int axis = 0; axis < 3; ++axis) box.side[axis] = boxes.low[axis][n], box.side[3 + axis] = boxes.high[axis][n];
  return box;
}

/// Finds the target's triangles whose boxes overlap a box: a warp descends the BVH, two packets of sixteen at a time.
/// Calls use(this lane has one, its BVH index, its box), all lanes together, until it returns false. `words`: shared
/// memory for `capacity` packets; if it does not suffice, the result is false, and triangles are missing.
template <class Use>
STANDOFF_DEVICE bool for_overlapping_boxes(const FlatBox& box, const DeviceBodyView& body, std::uint32_t* words,
                                           int capacity, Use use) {
  NodeStack<std::uint32_t> nodes(words, capacity, packet_word(body.top, 0));
  while (!nodes.empty()) {
    const std::uint32_t word = nodes.take(0, kNoPacket);
    const int level = level_of(word);
    const std::uint32_t child = packet_of(word) * kLanes + lane_in_warp() % kLanes;
    FlatBox own{};
    bool near = word != kNoPacket;
    if (near) {
      own = box_in(body.boxes[level][packet_of(word)], lane_in_warp() % kLanes);
      near = overlap(own, box);
    }
    const std::uint32_t inner = __ballot_sync(kWarp, near && level > 0);
    if (!nodes.put(inner, __popc(inner & lanes_below(lane_in_warp())), packet_word(level - 1, child))) return false;
    const bool leaf = near && level == 0;
    if (__ballot_sync(kWarp, leaf) != 0 && !use(leaf, child, own)) return true;
  }
  return true;
}

/// Takes the next query for the calling warp. Queries are not assigned beforehand, as some take a thousand times as
/// long as others.
STANDOFF_DEVICE std::uint32_t take_query(std::uint32_t* next) {
  std::uint32_t n = 0;
  if (lane_in_warp() == 0) n = atomicAdd(next, std::uint32_t{1});
  return __shfl_sync(kWarp, n, 0);
}

/// Answers queries until none is left, a warp per query. Search is made from a task, a query and the warp's shared
/// memory.
template <class Search, class Task, class Shared>
STANDOFF_DEVICE void answer_queries(const Task& task, Shared* shared) {
  for (;;) {
    const std::uint32_t n = take_query(task.next);
    if (n >= task.count) return;
    const auto answer = Search(task, task.queries[n], shared[threadIdx.x / 32]).run();
    if (lane_in_warp() == 0) task.answers[n] = answer;
  }
}

/// Runs a kernel over queries on the current device. make_task takes queries, answers and a counter in device memory.
template <unsigned kThreads, class Task, class Query, class Answer, class MakeTask>
void run_queries(const char* label, void (*kernel)(Task), std::span<const Query> queries, std::span<Answer> answers,
                 MakeTask make_task) {
  const auto count = static_cast<std::int64_t>(queries.size());
  const auto query_bytes = static_cast<std::int64_t>(queries.size_bytes()),
             answer_bytes = static_cast<std::int64_t>(answers.size_bytes());
  const Memory query_memory(query_bytes), answer_memory(answer_bytes), next(sizeof(std::uint32_t));
  copy_in(query_memory.as<void>(), queries.data(), query_bytes);
  fill_bytes(nullptr, next.as<void>(), 0, sizeof(std::uint32_t));
  const Task task = make_task(query_memory.as<Query>(), answer_memory.as<Answer>(), static_cast<std::uint32_t>(count),
                              next.as<std::uint32_t>());
  constexpr std::int64_t kWarps = kThreads / 32;
  launch(nullptr, label, kernel, std::min<std::int64_t>(kManyBlocks, (count + kWarps - 1) / kWarps), kThreads, task);
  copy_out(answers.data(), answer_memory.as<void>(), answer_bytes);
}

}  // namespace standoff::STANDOFF_PLATFORM
