// Where two surfaces touch. Packets of the tree's triangles that may touch are gone through in an order that jumps over
// the whole contact area, and give a few pairs each; what room is left is filled by a second round.
#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/batch.h"
#include "collision/close_pairs.h"
#include "collision/pair.h"

namespace difi {
namespace collision {
namespace {

// Packets that share the contacts in the first round, at most: more would spread them better, but each has to be
// fetched.
constexpr std::size_t kSharers = 32;

class Gather {
 public:
  Gather(const Pair& pair, const ContactOptions& options)
      : pair_(pair),
        kernels_(kernels()),
        margin_(options.margin),
        limit_(static_cast<float>(options.margin) * 1.000001f + pair.slack),
        most_(static_cast<std::size_t>(options.most)),
        close_(pair, kernels_, limit_) {}

  Contacts run() {
    if (pair_.root_gap() > margin_ + pair_.slack) return {};
    find_packets(pair_.tree.body->tree.top(), 0);
    const std::size_t count = packets_.size();
    const std::size_t share = most_ / std::clamp<std::size_t>(count, 1, kSharers) + 1;
    // Numbers with their bits turned around: each falls into the largest gap the ones before it have left.
    const int bits = static_cast<int>(std::bit_width(count));
    std::vector<std::uint32_t> unfinished;
    for (std::size_t n = 0; n < std::size_t{1} << bits && !full(); ++n) {
      std::size_t at = 0;
      for (int bit = 0; bit < bits; ++bit) at |= (n >> bit & 1) << (bits - 1 - bit);
      if (at < count && !take(packets_[at], 0, share)) unfinished.push_back(packets_[at]);
    }
    for (std::size_t n = 0; n < unfinished.size() && !full(); ++n) take(unfinished[n], share, most_ + 1);
    return std::move(result_);
  }

 private:
  bool full() const { return result_.overflow; }

  void find_packets(int level, std::uint32_t packet) {
    if (level == 0) return packets_.push_back(packet);
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.field.body->view, pair_.place, pair_.tree.body->tree.levels[level].balls[packet], limit_, gap);
    for (int n = 0; n < kLanes; ++n)
      if (gap[n] <= limit_) find_packets(level - 1, packet * kLanes + n);
  }

  // Adds the pairs of a packet from the `first`-th up to the `end`-th; false when there may be more.
  bool take(std::uint32_t packet, std::size_t first, std::size_t end) {
    // Packets come here because they reach the surface: asking the field for each triangle would cost more than it
    // saves.
    const auto left = static_cast<std::uint32_t>(pair_.tree.body->tree.order.size()) - packet * kLanes;
    const std::uint32_t lanes = left < kLanes ? (1u << left) - 1 : 0xffffu;
    seen_ = 0, first_ = first, end_ = end;
    return close_.visit(packet, lanes, [this](std::uint32_t f, std::uint32_t t) { return test(f, t); });
  }

  // False when no more is wanted.
  bool test(std::uint32_t field_place, std::uint32_t tree_place) {
    const Corners p = pair_.field.world(field_place), q = pair_.tree.world(tree_place);
    Overlap found;
    if (triangles_touch(p, q)) {
      if (++seen_ <= first_) return true;
      found = overlap(p, q);
    } else {
      if (!(margin_ > 0)) return true;
      const ClosestPair pair = closest_points(p, q);
      if (!(pair.distance_sq <= margin_ * margin_)) return true;
      if (++seen_ <= first_) return true;
      const double apart = std::sqrt(pair.distance_sq);
      found = {(pair.on_p + pair.on_q) * 0.5, (pair.on_q - pair.on_p) * (1 / apart), -apart};
    }
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
    return seen_ < end_;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;
  const std::size_t most_;
  ClosePairs close_;
  std::vector<std::uint32_t> packets_;
  Contacts result_;
  // The packet at work.
  std::size_t seen_ = 0, first_ = 0, end_ = 0;
};

void check(const ContactOptions& options) {
  if (options.most < 1) throw Error(ErrorCode::usage, "contacts: the number of contacts must be one or more");
  if (!(options.margin >= 0) || !(options.margin <= 1e30))
    throw Error(ErrorCode::usage, "contacts: the margin must be zero or more, and finite");
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
