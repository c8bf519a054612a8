// SPDX-License-Identifier: Apache-2.0
// The sides that src/sign finds of a grid's samples, held against winding numbers that are known otherwise.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/progress.h"
#include "field/reference.h"
#include "sign/methods.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {

struct Sides {
  std::int64_t inside = 0, outside = 0, on_surface = 0, wrong = 0;

  Sides& operator+=(const Sides& more) {
    inside += more.inside;
    outside += more.outside;
    on_surface += more.on_surface;
    wrong += more.wrong;
    return *this;
  }
  std::int64_t samples() const { return inside + outside; }
};

/// By the winding number of the mesh as it is: parts that are inside out count as such.
inline constexpr SignOptions kAsItIs{.method = SignMethod::winding, .as_oriented = true};

/// What is decided for a mesh.
inline SignPlan plan_of(MeshView mesh, const SignOptions& options) {
  ProgressMeter unwatched;
  return plan_sign(mesh, options, unwatched);
}

/// A closed mesh whose samples are asked for.
class SidesOfSamples {
 public:
  explicit SidesOfSamples(Mesh mesh, const SignOptions& options = kAsItIs)
      : mesh_(std::move(mesh)), options_(options), plan_(plan_of(mesh_, options)), groups_(mesh_) {}

  const Mesh& mesh() const { return mesh_; }

  /// Against known(p), which gives a ReferenceWinding.
  template <class Known>
  Sides compare(const Grid& grid, const Known& known) const {
    const ProgressCallback none;
    ProgressMeter progress(none);
    SignPlan plan = plan_;
    const auto sides = make_signs(mesh_, plan, options_, {grid}, progress);
    sides->load(0);  // everything at once
    InsideRows rows(grid);
    Sides found;
    for (std::int64_t tz = 0; 8 * tz < grid.size.z; ++tz)
      for (std::int64_t ty = 0; 8 * ty < grid.size.y; ++ty) {
        rows.clear(ty, tz);
        sides->fill(rows, ty, tz);
        for (int row = 0; row < InsideRows::kRows; ++row)
          for (std::int64_t i = 0; i < grid.size.x && rows.in_grid(row); ++i) {
            const ReferenceWinding winding = known(grid.position(i, 8 * ty + row % 8, 8 * tz + row / 8));
            if (winding.on_surface) {
              ++found.on_surface;
              continue;
            }
            const bool inside = is_inside(std::llround(winding.value));
            ++(inside ? found.inside : found.outside);
            found.wrong += inside != rows.is_inside(row, i);
          }
      }
    return found;
  }
  /// Against rays along y.
  Sides compare(const Grid& grid) const {
    return compare(grid, [&](const Vec3& p) { return winding_by_crossings({mesh_}, groups_, p); });
  }

 private:
  bool is_inside(long long winding) const {
    if (options_.method == SignMethod::parity || options_.rule == WindingRule::odd) return winding % 2 != 0;
    return options_.rule == WindingRule::nonzero ? winding != 0 : winding > 0;
  }

  Mesh mesh_;
  SignOptions options_;
  SignPlan plan_;
  TriangleGroups groups_;
};

/// A point on a triangle but for rounding: within a face, or on an edge, or a corner.
inline Vec3 near_surface(const Mesh& mesh, Random& random) {
  const auto t = MeshView(mesh).corners(random.below(static_cast<std::uint32_t>(mesh.triangles.size())));
  const double u = random.between(0, 1), v = random.between(0, 1);
  switch (random.below(4)) {
    case 0:
      return t[0];
    case 1:
      return t[0] * u + t[1] * (1 - u);
    default:
      return t[0] * (1 - u) + t[1] * (u * (1 - v)) + t[2] * (u * v);
  }
}

/// 8x8x8 samples about a point, each one unit in the last place of its coordinates from the next. For coordinates near
/// 0 the steps are those of a number a millionth as large as the largest coordinate.
inline Grid ulps_about(const Vec3& p) {
  const auto ulp = [&](double c) {
    const double size = std::max({std::abs(c), max_norm(p) * 1e-6, 1e-80});
    return std::nextafter(size, std::numeric_limits<double>::infinity()) - size;
  };
  const Vec3 step{ulp(p.x), ulp(p.y), ulp(p.z)};
  return {{8, 8, 8}, p - step * 4, step};
}

/// 8x8x8 samples somewhere in and around a box.
inline Grid anywhere(const Box& box, Random& random) {
  const Vec3 extent = max(box.extent(), Vec3{1, 1, 1} * (1e-3 * max_norm(box.extent())));
  const auto share = [&] {
    return Vec3{random.between(0.02, 0.16), random.between(0.02, 0.16), random.between(0.02, 0.16)};
  };
  const Vec3 step = extent * share();
  return {{8, 8, 8},
          box.min + (extent - step * 7) *
                        Vec3{random.between(-0.1, 1.1), random.between(-0.1, 1.1), random.between(-0.1, 1.1)},
          step};
}

}  // namespace standoff::testing
