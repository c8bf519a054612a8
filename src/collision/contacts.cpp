// Where two surfaces touch. Packets of the tree's triangles that may touch are gone through in an order that jumps over
// the whole contact area; the pairs they give are decided in turns, one of each packet after the other, until there are
// enough.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/batch.h"
#include "collision/close_pairs.h"
#include "collision/pair_batch.h"

namespace difi {
namespace collision {
namespace {

// Packets whose pairs take turns, at least: more would spread the contacts better, but each has to be looked up.
constexpr std::size_t kTakeTurns = 32;

// Packets asked for from memory before they are looked up.
constexpr std::size_t kAhead = 2;

// The packets in the order of their numbers with the bits turned around: each falls into the largest gap the ones
// before it have left.
std::vector<std::uint32_t> spread(const std::vector<std::uint32_t>& packets) {
  std::vector<std::uint32_t> result;
  result.reserve(packets.size());
  const std::size_t end = std::bit_ceil(packets.size());
  std::size_t at = 0;
  for (std::size_t number = 0; number < end; ++number) {
    if (at < packets.size()) result.push_back(packets[at]);
    std::size_t bit = end / 2;  // one is added from the other end
    for (; (at & bit) != 0; bit /= 2) at ^= bit;
    at |= bit;
  }
  return result;
}

class Gather {
 public:
  Gather(const Pair& pair, const ContactOptions& options)
      : pair_(pair),
        kernels_(kernels()),
        margin_(options.margin),
        limit_(pair.limit(options.margin)),
        most_(static_cast<std::size_t>(options.most)),
        close_(pair, kernels_, limit_),
        batch_(pair, kernels_) {}

  Contacts run() {
    if (pair_.apart(margin_)) return {};
    find_packets(pair_.tree.body->tree.top(), 0);
    packets_ = spread(packets_);
    std::size_t next = 0;
    do {
      candidates_.clear();
      ends_.clear();
      for (; next < packets_.size() && !enough(next); ++next) {
        if (next + kAhead < packets_.size()) fetch(pair_.tree.body->tree.faces[packets_[next + kAhead]]);
        look_up(packets_[next]);
      }
    } while (decide_in_turns() && next < packets_.size());
    return std::move(result_);
  }

 private:
  struct Candidate {
    std::uint32_t field_place, tree_place;
  };

  void find_packets(int level, std::uint32_t packet) {
    if (level == 0) return packets_.push_back(packet);
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.field.body->view, pair_.place, pair_.tree.body->tree.levels[level].balls[packet], limit_, gap);
    for (int n = 0; n < kLanes; ++n)
      if (gap[n] <= limit_) find_packets(level - 1, packet * kLanes + n);
  }

  // About every second candidate turns out to touch.
  bool enough(std::size_t looked_up) const {
    return looked_up >= kTakeTurns && candidates_.size() / 2 > most_ - result_.contacts.size();
  }

  // Packets come here because they reach the surface: asking the field for each triangle would cost more than it saves.
  void look_up(std::uint32_t packet) {
    close_.visit(packet, [this](std::uint32_t field_place, std::uint32_t tree_place) {
      fetch(pair_.field.body->corners[field_place]);
      fetch(pair_.tree.body->corners[tree_place]);
      candidates_.push_back({field_place, tree_place});
      return true;
    });
    if (candidates_.size() > (ends_.empty() ? 0 : ends_.back())) ends_.push_back(candidates_.size());
  }

  // False when there are more contacts than wanted.
  bool decide_in_turns() {
    result_.contacts.reserve(std::min(most_, result_.contacts.size() + candidates_.size()));
    for (std::size_t turn = 0, left = ends_.size(); left > 0; ++turn) {
      left = 0;
      for (std::size_t n = 0; n < ends_.size(); ++n) {
        const std::size_t at = (n == 0 ? 0 : ends_[n - 1]) + turn;
        if (at >= ends_[n]) continue;
        ++left;
        batch_.add(candidates_[at].field_place, candidates_[at].tree_place);
        if (batch_.full() && !settle()) return false;
      }
    }
    return settle();
  }

  bool settle() {
    return batch_.settle([this](std::uint32_t field_place, std::uint32_t tree_place, const Overlap* touching) {
      if (touching) return add(field_place, tree_place, *touching);
      if (!(margin_ > 0)) return true;
      const ClosestPair pair = closest_points(pair_.field.world(field_place), pair_.tree.world(tree_place));
      if (!(pair.distance_sq <= margin_ * margin_)) return true;
      const double apart = std::sqrt(pair.distance_sq);
      return add(field_place, tree_place,
                 {(pair.on_p + pair.on_q) * 0.5, (pair.on_q - pair.on_p) * (1 / apart), -apart});
    });
  }

  // False when there is no room.
  bool add(std::uint32_t field_place, std::uint32_t tree_place, const Overlap& found) {
    if (result_.contacts.size() == most_) {
      result_.overflow = true;
      return false;
    }
    const std::uint32_t of_field = pair_.field.triangle(field_place), of_tree = pair_.tree.triangle(tree_place);
    ContactPoint contact{found.point, found.normal, found.depth, of_field, of_tree};
    if (pair_.swapped) {
      contact.normal = contact.normal * -1.0;
      std::swap(contact.triangle_a, contact.triangle_b);
    }
    result_.contacts.push_back(contact);
    return true;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;
  const std::size_t most_;
  ClosePairs close_;
  PairBatch batch_;
  std::vector<std::uint32_t> packets_;
  std::vector<Candidate> candidates_;  // of some packets, one packet after the other
  std::vector<std::size_t> ends_;      // where each packet's candidates end
  Contacts result_;
};

void check(const ContactOptions& options) {
  if (options.most < 1) throw Error(ErrorCode::usage, "contacts: the number of contacts must be one or more");
  if (!(options.margin >= 0) || !(options.margin <= 1e30))
    throw Error(ErrorCode::usage, "contacts: the margin must be from 0 to 1e30");
}

}  // namespace
}  // namespace collision

Contacts contacts(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b,
                  const ContactOptions& options) {
  collision::check(options);
  validate(pose_a);
  validate(pose_b);
  const collision::Pair pair(a, pose_a, b, pose_b);
  return collision::Gather(pair, options).run();
}

std::vector<Contacts> contacts_all(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                   std::span<const Pose> poses_b, const ContactOptions& options, int threads) {
  collision::check(options);
  validate(pose_a);
  collision::validate_all(poses_b);
  return collision::for_each<Contacts>(poses_b.size(), threads, [&](std::size_t n) {
    const collision::Pair pair(a, pose_a, b, poses_b[n]);
    return collision::Gather(pair, options).run();
  });
}

}  // namespace difi
