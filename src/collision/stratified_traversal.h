// SPDX-License-Identifier: Apache-2.0
// Visits the probe's packets of triangles that may reach the target's surface in bit-reversed, round-robin order, so
// that any prefix of them is spread over the contact area. Nodes are expanded lazily: no more of a large contact area
// is visited than is asked for.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "collision/query_pair.h"

namespace standoff::collision {

class StratifiedTraversal {
 public:
  /// Packets farther than `limit` are left out as far as their spheres show it. At least `breadth` nodes take turns,
  /// where there are as many.
  StratifiedTraversal(const QueryPair& pair, float limit, std::size_t breadth)
      : pair_(pair), kernels_(pair.kernels), limit_(limit) {
    int level = pair.probe.body->bvh.top();
    std::vector<std::uint32_t> front, below;
    front.reserve(kLanes * breadth);
    below.reserve(kLanes * breadth);
    front.push_back(0);
    for (; level > 0 && front.size() < breadth; --level) {
      below.clear();
      for (const std::uint32_t packet : front) {
        const Branches branches = reaching(level, packet);
        below.insert(below.end(), branches.packet, branches.packet + branches.count);
      }
      front.swap(below);
    }
    nodes_.reserve(2 * front.size());
    all_ = bit_reversed(front, level);
  }

  /// The next packet of the lowest level; none when all have been given.
  std::optional<std::uint32_t> next() { return next(all_); }

 private:
  // Nodes that stand together in nodes_, and whose turn it is.
  struct RoundRobin {
    std::uint32_t first = 0, count = 0, now = 0;
  };
  struct Node {
    std::uint32_t packet;
    std::int16_t level;
    bool open = false;
    RoundRobin branches;
  };

  std::optional<std::uint32_t> next(RoundRobin& turns) {
    while (turns.count > 0) {
      if (turns.now == turns.count) turns.now = 0;
      const std::uint32_t at = turns.first + turns.now;
      if (nodes_[at].level == 0) {
        const std::uint32_t packet = nodes_[at].packet;
        remove_current(turns);
        return packet;
      }
      if (!nodes_[at].open) open(at);
      RoundRobin branches = nodes_[at].branches;  // nodes_ may move
      const auto packet = next(branches);
      nodes_[at].branches = branches;
      if (packet) {
        ++turns.now;
        return packet;
      }
      remove_current(turns);
    }
    return {};
  }

  // The one whose turn it is has nothing more to give.
  void remove_current(RoundRobin& turns) {
    --turns.count;
    if (turns.now == 0)
      ++turns.first;
    else
      std::move(nodes_.begin() + turns.first + turns.now + 1, nodes_.begin() + turns.first + turns.count + 1,
                nodes_.begin() + turns.first + turns.now);
  }

  void open(std::uint32_t at) {
    const int level = nodes_[at].level;
    const Branches branches = reaching(level, nodes_[at].packet);
    const RoundRobin turns = bit_reversed(std::span(branches.packet, branches.count), level - 1);
    nodes_[at].branches = turns;
    nodes_[at].open = true;
  }

  struct Branches {
    std::uint32_t packet[kLanes];
    std::size_t count = 0;
  };
  Branches reaching(int level, std::uint32_t packet) const {
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.target.body->view, pair_.transform, pair_.probe.body->bvh.levels[level].spheres[packet], limit_,
                  gap);
    Branches branches;
    for (std::uint32_t n = 0; n < kLanes; ++n)
      if (gap[n] <= limit_) branches.packet[branches.count++] = packet * kLanes + n;
    if (level > 1)
      for (std::size_t n = 0; n < branches.count; ++n)
        fetch(pair_.probe.body->bvh.levels[level - 1].spheres[branches.packet[n]]);
    return branches;
  }

  // Nodes in the order of their numbers with the bits rotated around: each falls into the largest gap the ones before
  // it have left.
  RoundRobin bit_reversed(std::span<const std::uint32_t> packets, int level) {
    const auto count = static_cast<std::uint32_t>(packets.size()), end = std::bit_ceil(count);
    const RoundRobin turns{static_cast<std::uint32_t>(nodes_.size()), count};
    std::uint32_t at = 0;
    for (std::uint32_t number = 0; number < end; ++number) {
      if (at < count) nodes_.push_back({packets[at], static_cast<std::int16_t>(level), false, {}});
      std::uint32_t bit = end / 2;  // one is added from the other end
      for (; (at & bit) != 0; bit /= 2) at ^= bit;
      at |= bit;
    }
    return turns;
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const float limit_;
  std::vector<Node> nodes_;
  RoundRobin all_;
};

}  // namespace standoff::collision
