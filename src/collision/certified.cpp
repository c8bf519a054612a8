// What the field alone can say. Free: no ball of a triangle reaches the surface. Hit, with a margin: a corner of a
// triangle is nearer than it, for d(x) <= s + |x - x_i|. Without a margin an unsigned field cannot tell touching
// from nearly touching: ambiguous.
#include <cmath>

#include "collision/find_intersecting.h"

namespace standoff::collision {
namespace {

class Certify {
 public:
  Certify(const Pair& pair, double margin)
      : pair_(pair), kernels_(kernels()), margin_(margin), limit_(pair.limit(margin)) {}

  Verdict run() {
    if (pair_.apart(margin_)) return Verdict::free;
    visit(pair_.tree.body->tree.top(), 0);
    return hit_ ? Verdict::hit : near_ ? Verdict::ambiguous : Verdict::free;
  }

 private:
  void visit(int level, std::uint32_t packet) {
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.field.body->view, pair_.place, pair_.tree.body->tree.levels[level].balls[packet], limit_, gap);
    for (int n = 0; n < kLanes && !hit_ && !(near_ && margin_ == 0); ++n) {
      if (gap[n] > limit_) continue;
      const std::uint32_t child = packet * kLanes + n;
      if (level > 0) {
        visit(level - 1, child);
      } else {
        near_ = true;
        for (const Vec3& corner : pair_.tree.body->corners[child])
          hit_ = hit_ || upper_bound(apply(pair_.relative, corner - pair_.tree.body->middle)) <= margin_;
      }
    }
  }

  double upper_bound(Vec3 x) const {
    const FieldBounds& f = pair_.field.body->field;
    const Vec3 u = (x - f.origin) * (1 / f.spacing);
    const auto nearest = [](double at, std::int64_t size) {
      return static_cast<std::int64_t>(std::floor(std::clamp(at, 0.0, static_cast<double>(size - 1)) + 0.5));
    };
    const Size3 at{nearest(u.x, f.size.x), nearest(u.y, f.size.y), nearest(u.z, f.size.z)};
    const double off = length(x - f.origin - Vec3{double(at.x), double(at.y), double(at.z)} * f.spacing);
    const auto tiles = [](std::int64_t n) { return (n + 7) / 8; };
    const std::int32_t slot =
        f.slots[static_cast<std::size_t>((at.z / 8 * tiles(f.size.y) + at.y / 8) * tiles(f.size.x) + at.x / 8)];
    const int sample = f.samples[static_cast<std::size_t>(slot) * 512 +
                                 static_cast<std::size_t>((at.z % 8 * 8 + at.y % 8) * 8 + at.x % 8)];
    // 255 stands for the band's half-width and all beyond it: no upper bound. Samples were rounded down by a step and
    // compute()'s error at the most.
    if (sample == 255) return std::numeric_limits<double>::infinity();
    return (sample + 1) * f.band() / 255 + 3e-5 * f.spacing + off + pair_.slack;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;
  bool near_ = false, hit_ = false;
};

}  // namespace

Verdict certify(const Pair& pair, double margin) { return Certify(pair, margin).run(); }

}  // namespace standoff::collision
