// SPDX-License-Identifier: Apache-2.0
// Decides from the field alone. Free: no sphere of a triangle reaches the surface. Hit, with a margin: a corner of a
// triangle is nearer than it, for d(x) <= s + |x - x_i|. Without a margin, bounds of the
// distance cannot tell touching from nearly touching: ambiguous.
#include "collision/certified.h"

#include <cmath>

#include "collision/body/sphere_bound.h"
#include "geometry/rounding.h"

namespace standoff::collision {
namespace {

// compute()'s error within the band of the fine field, in its spacings, with room for rounding.
constexpr double kFineError = 3e-5;
static_assert(kFineError > promised_error(kBandSamples, 1));

class Certify {
 public:
  Certify(const QueryPair& pair, double margin)
      : pair_(pair), kernels_(pair.kernels), margin_(margin), limit_(pair.limit(margin)) {}

  Verdict run() {
    if (pair_.apart(margin_)) return Verdict::free;
    visit(pair_.probe.body->bvh.top(), 0);
    return hit_ ? Verdict::hit : near_ ? Verdict::ambiguous : Verdict::free;
  }

 private:
  void visit(int level, std::uint32_t packet) {
    alignas(64) float gap[kLanes];
    kernels_.gaps(pair_.target.body->view, pair_.transform, pair_.probe.body->bvh.levels[level].spheres[packet], limit_,
                  gap);
    for (int n = 0; n < kLanes && !hit_ && !(near_ && margin_ == 0); ++n) {
      if (gap[n] > limit_) continue;
      const std::uint32_t child = packet * kLanes + n;
      if (level > 0) {
        visit(level - 1, child);
      } else {
        near_ = true;
        for (const Vec3& corner : pair_.probe.body->corners[child])
          hit_ = hit_ || upper_bound(apply(pair_.relative, corner - pair_.probe.body->middle)) <= margin_;
      }
    }
  }

  // From the fine sample nearest to x; infinite where it is clamped.
  double upper_bound(Vec3 x) const {
    const FieldBounds& f = pair_.target.body->field;
    const FieldView& view = pair_.target.body->view;
    const Vec3 u = (x - f.origin) * (1 / f.spacing);
    const auto nearest = [](double at, std::int64_t size) {
      return static_cast<std::int32_t>(std::floor(std::clamp(at, 0.0, static_cast<double>(size - 1)) + 0.5));
    };
    const std::int32_t i = nearest(u.x, f.size.x), j = nearest(u.y, f.size.y), k = nearest(u.z, f.size.z);
    const double off = length(x - f.origin - Vec3{double(i), double(j), double(k)} * f.spacing);
    const int sample = fine_sample(view, tile_of(view, i, j, k), index_in_tile(i, j, k));
    if (sample == kClampedSample) return std::numeric_limits<double>::infinity();
    // Samples were rounded down by a step and compute()'s error at the most.
    return (sample + 1) * f.thickness() / kClampedSample + kFineError * f.spacing + off + pair_.slack;
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const double margin_;
  const float limit_;
  bool near_ = false, hit_ = false;
};

}  // namespace

Verdict certify(const QueryPair& pair, double margin) { return Certify(pair, margin).run(); }

}  // namespace standoff::collision
