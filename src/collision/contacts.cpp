// SPDX-License-Identifier: Apache-2.0
// Finds contacts of two surfaces. The probe's packets are visited in an order that spreads over the contact area; their
// candidate pairs are decided round-robin, one of each packet after the other, until there are enough contacts.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "collision/close_pairs.h"
#include "core/guarded.h"
#include "core/number_text.h"

namespace standoff {
namespace collision {
namespace {

// The packets of a round-robin. More would spread the contacts better, but each costs a traversal.
constexpr std::size_t kTakeTurns = 24;

// The walk begins from at least this many nodes: in a BVH with so few, all packets are found at once, which costs less
// for each.
constexpr std::size_t kRoots = 2 * kLanes;

// Closest points nearer than this share of the pair's extent differ by little more than rounding.
constexpr double kDirectionTold = 1e6 * kDistanceRounding;

// Packets are prefetched this many steps ahead.
constexpr std::size_t kAhead = 2;

// Visits the probe's packets of triangles that may reach the target's surface in bit-reversed, round-robin order, so
// that any prefix of them is spread over the contact area. Nodes are expanded lazily: no more of a large contact area
// is visited than is asked for.
class StratifiedTraversal {
 public:
  /// Excludes packets farther than `limit`, if their spheres show it. At least `breadth` nodes take turns, if there are
  /// that many.
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

  /// The next packet of the lowest level; nothing at the end.
  std::optional<std::uint32_t> next() { return next(all_); }

 private:
  // A range of nodes_, and the node whose turn it is.
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
      RoundRobin branches = nodes_[at].branches;  // a copy, as nodes_ may grow and move
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

  // Removes the node whose turn it is: it has no more packets.
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
    kernels_.gaps(pair_.target.body->view, pair_.transform, pair_.probe.body->bvh.spheres[level][packet], limit_, gap);
    Branches branches;
    for (std::uint32_t n = 0; n < kLanes; ++n)
      if (gap[n] <= limit_) branches.packet[branches.count++] = packet * kLanes + n;
    if (level > 1)
      for (std::size_t n = 0; n < branches.count; ++n)
        fetch(pair_.probe.body->bvh.spheres[level - 1][branches.packet[n]]);
    return branches;
  }

  // Orders nodes by their numbers with reversed bits: each falls into the largest gap that the ones before it left.
  RoundRobin bit_reversed(std::span<const std::uint32_t> packets, int level) {
    const auto count = static_cast<std::uint32_t>(packets.size()), end = std::bit_ceil(count);
    const RoundRobin turns{static_cast<std::uint32_t>(nodes_.size()), count};
    std::uint32_t at = 0;
    for (std::uint32_t number = 0; number < end; ++number) {
      if (at < count) nodes_.push_back({packets[at], static_cast<std::int16_t>(level), false, {}});
      std::uint32_t bit = end / 2;  // increment the reversed number
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

// The contact of triangles that do not intersect, at their closest points. If these are very near, rounding decides the
// direction between them.
Penetration between(const Corners& p, const Corners& q, const ClosestPair& pair) {
  const double apart = std::sqrt(pair.distance_sq);
  const bool has_direction = apart > kDirectionTold * extent_of(p, q);
  return {pair.on_p + pair.separation * 0.5, has_direction ? pair.separation * (1 / apart) : penetration(p, q).normal,
          -apart};
}

class ContactSearch {
 public:
  ContactSearch(const QueryPair& pair, const ContactOptions& options)
      : pair_(pair),
        margin_(options.margin),
        limit_(pair.limit(options.margin)),
        most_(static_cast<std::size_t>(options.most)),
        some_(ClosePairs::kAllLanes >> (kLanes - std::clamp<std::size_t>(most_ / kTakeTurns / 4, 1, kLanes))),
        traversal_(pair, limit_, kRoots),
        close_(pair, limit_),
        batch_(pair) {}

  ContactResult run() {
    if (pair_.apart(margin_)) return {};
    while (look_up_some() && decide_in_turns()) {
    }
    return std::move(result_);
  }

 private:
  struct Candidate {
    std::uint32_t target_index, probe_index;
  };

  // About every second candidate turns out to intersect.
  bool plenty() const { return candidates_.size() / 2 > most_ - result_.contacts.size(); }

  // Adds the candidates of some packets; false if none is left. The packets reach the surface, so testing each triangle
  // in the field would cost more than it saves. Once there are plenty of candidates, a packet only adds those of some
  // triangles, for the sake of spread.
  bool look_up_some() {
    candidates_.clear();
    ends_.clear();
    const std::size_t before = looked_up_;
    for (; looked_up_ < kTakeTurns || !plenty(); ++looked_up_) {
      while (packets_.size() <= next_ + kAhead && prefetch_next()) {
      }
      if (next_ < packets_.size()) {
        const std::uint32_t packet = packets_[next_++];
        const bool briefly = plenty();
        look_up(packet, briefly ? some_ : ClosePairs::kAllLanes);
        if (briefly) cut_short_.push_back(packet);
      } else if (!cut_short_.empty()) {
        look_up(cut_short_.back(), ~some_ & ClosePairs::kAllLanes);
        cut_short_.pop_back();
      } else {
        break;
      }
    }
    return looked_up_ > before;
  }

  // Prefetches the next packet; false if there is none.
  bool prefetch_next() {
    const auto packet = traversal_.next();
    if (packet) fetch(pair_.probe.body->bvh.triangles[packets_.emplace_back(*packet)]);
    return packet.has_value();
  }

  void look_up(std::uint32_t packet, std::uint32_t lanes) {
    const std::size_t before = candidates_.size();
    close_.visit(packet, lanes, [this](std::uint32_t target_index, std::uint32_t probe_index) {
      fetch(pair_.target.body->corners[target_index]);
      fetch(pair_.probe.body->corners[probe_index]);
      candidates_.push_back({target_index, probe_index});
      return true;
    });
    if (candidates_.size() > before) ends_.push_back(candidates_.size());
  }

  // Decides candidates round-robin; false if there are more contacts than wanted.
  bool decide_in_turns() {
    if (result_.contacts.empty()) result_.contacts.reserve(std::min(most_, candidates_.size()));
    for (std::size_t turn = 0, left = ends_.size(); left > 0; ++turn) {
      left = 0;
      for (std::size_t n = 0; n < ends_.size(); ++n) {
        const std::size_t at = (n == 0 ? 0 : ends_[n - 1]) + turn;
        if (at >= ends_[n]) continue;
        ++left;
        batch_.add(candidates_[at].target_index, candidates_[at].probe_index);
        if (batch_.full() && !settle()) return false;
      }
    }
    return settle();
  }

  bool settle() {
    return batch_.settle([this](std::uint32_t target_index, std::uint32_t probe_index, bool intersecting, auto where) {
      if (intersecting) return add(target_index, probe_index, where());
      if (!(margin_ > 0)) return true;
      const Corners p = pair_.target.world(target_index), q = pair_.probe.world(probe_index);
      const ClosestPair pair = closest_points(p, q);
      if (!(pair.distance_sq <= margin_ * margin_)) return true;
      return add(target_index, probe_index, between(p, q, pair));
    });
  }

  // Adds a contact; false if enough were found before.
  bool add(std::uint32_t target_index, std::uint32_t probe_index, const Penetration& found) {
    if (result_.contacts.size() == most_) {
      result_.overflow = true;
      return false;
    }
    const TrianglesOfBoth triangles = pair_.triangles_of(target_index, probe_index);
    const Vec3 normal = pair_.swapped ? found.normal * -1.0 : found.normal;
    result_.contacts.push_back({found.point, normal, found.depth, triangles.a, triangles.b});
    return true;
  }

  const QueryPair& pair_;
  const double margin_;
  const float limit_;
  const std::size_t most_;
  const std::uint32_t some_;  // some lanes of a packet; each has a few candidates if bodies lie on each other
  StratifiedTraversal traversal_;
  std::vector<std::uint32_t> packets_;  // packets in the order of the walk
  std::size_t next_ = 0, looked_up_ = 0;
  std::vector<std::uint32_t> cut_short_;  // packets of which only the lanes some_ were visited
  ClosePairs close_;
  PairBatch batch_;
  std::vector<Candidate> candidates_;  // packet by packet
  std::vector<std::size_t> ends_;      // the end of each packet's candidates
  ContactResult result_;
};

void check(const ContactOptions& options) {
  if (options.most < 1)
    throw Error(ErrorCode::usage, "contacts: the number of contacts must be one or more; give as many as you can use");
  if (!(options.margin >= 0) || !(options.margin <= kMaxMargin))
    throw Error(ErrorCode::usage,
                "contacts: the margin must be from 0 to " + number_text(kMaxMargin) + "; give it in world units");
}

}  // namespace
}  // namespace collision

ContactResult contacts(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                       const ContactOptions& options) try {
  collision::check(options);
  validate(pose_a);
  validate(pose_b);
  const collision::QueryPair pair(a, pose_a, b, pose_b, collision::best_kernels());
  return collision::ContactSearch(pair, options).run();
} catch (...) {
  throw_as_error("contacts");
}

BatchResult<ContactResult> contacts_all(const Body& a, const Pose& pose_a, const Body& b, std::span<const Pose> poses_b,
                                        const ContactOptions& options, const Execution& execution) try {
  collision::check(options);
  validate("contacts", execution, Runs::on_the_cpu);
  validate(pose_a);
  collision::validate_all(poses_b);
  const collision::Kernels& kernels = collision::kernels_for(execution.simd, "contacts");
  auto results = collision::for_each<ContactResult>(poses_b.size(), execution.threads, [&](std::size_t n) {
    const collision::QueryPair pair(a, pose_a, b, poses_b[n], kernels);
    return collision::ContactSearch(pair, options).run();
  });
  return {std::move(results), {.backend = "cpu", .device = {}}};
} catch (...) {
  throw_as_error("contacts");
}

}  // namespace standoff
