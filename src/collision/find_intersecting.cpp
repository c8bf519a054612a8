// Balls of one body's tree against the other's field, nearest first; where the field cannot tell, triangles.
#include "collision/find_intersecting.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "collision/close_pairs.h"
#include "collision/pair_batch.h"

namespace standoff::collision {
namespace {

class Search {
 public:
  Search(const Pair& pair, double margin)
      : pair_(pair),
        kernels_(kernels()),
        margin_(margin),
        limit_(pair.limit(margin)),
        close_(pair, kernels_, limit_),
        batch_(pair, kernels_) {}

  std::optional<Touching> run() {
    if (pair_.apart(margin_) || !visit(pair_.tree.body->tree.top(), 0)) return {};
    return found_;
  }

 private:
  bool visit(int level, std::uint32_t packet) {
    if (level == 0) {
      // The packet reaches the surface: its triangles' boxes tell more than the field would.
      const bool none =
          close_.visit(packet, ClosePairs::kAllLanes, [this](std::uint32_t field_place, std::uint32_t tree_place) {
            batch_.add(field_place, tree_place);
            return !batch_.full() || settle();
          });
      return !(none && settle());
    }
    alignas(64) float gap[kLanes];
    const Level& nodes = pair_.tree.body->tree.levels[level];
    kernels_.gaps(pair_.field.body->view, pair_.place, nodes.balls[packet], limit_, gap);
    int lanes[kLanes];
    const int count = lanes_within(gap, limit_, lanes);
    for (int n = 0; n < count; ++n)
      if (visit(level - 1, packet * kLanes + lanes[n])) return true;
    return false;
  }

  // False when one of the pairs that wait touches.
  bool settle() {
    return batch_.settle([this](std::uint32_t field_place, std::uint32_t tree_place, bool hit, auto&&) {
      if (!hit && margin_ > 0) {
        const Corners p = pair_.field.world(field_place), q = pair_.tree.world(tree_place);
        hit = closest_points(p, q).distance_sq <= margin_ * margin_;
      }
      if (hit) found_ = {field_place, tree_place};
      return !hit;
    });
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;  // balls and boxes farther away than this are farther than the margin
  ClosePairs close_;
  PairBatch batch_;
  Touching found_{};
};

}  // namespace

std::optional<Touching> find_touching(const Pair& pair, double margin) {
  // Bodies of one shape in one place have the same first triangle.
  if (pair.relative == Pose{} && triangles_touch(pair.field.world(0), pair.tree.world(0))) return Touching{0, 0};
  return Search(pair, margin).run();
}

}  // namespace standoff::collision
