#include "field/memory.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "core/field_bytes.h"
#include "core/guarded.h"
#include "core/threads.h"
#include "field/backend.h"
#include "field/options.h"
#include "field/skip.h"
#include "geometry/sample_range.h"
#include "standoff/verify.h"

namespace standoff {
namespace {

constexpr std::int64_t kSide = DistanceField::kTileSide;

double tiles_of(const Size3& size) {
  const auto along = [](std::int64_t samples) { return static_cast<double>((samples + kSide - 1) / kSide); };
  return along(size.x) * along(size.y) * along(size.z);
}

double tiles_of(const SampleRange& range) {
  if (range.empty()) return 0;
  const auto along = [](std::int64_t begin, std::int64_t end) {
    return static_cast<double>((end - 1) / kSide - begin / kSide + 1);
  };
  return along(range.begin.x, range.end.x) * along(range.begin.y, range.end.y) * along(range.begin.z, range.end.z);
}

// No more tiles hold a band sample than lie in all triangles' grown boxes together. Sums of whole numbers are exact up
// to 2^53, in any order; beyond that nothing fits.
double tiles_reached(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options) {
  const double all = tiles_of(grid.size);
  if (std::isinf(thickness)) return all;
  // More than any method's rounding, which could find a sample nearer than it is.
  const double reach = thickness + 10 * allowed_error(grid, thickness);
  const auto add = [&](const tbb::blocked_range<std::size_t>& triangles, double sum) {
    for (std::size_t t = triangles.begin(); t < triangles.end(); ++t) {
      const Vec3 a = mesh.corner(t, 0), b = mesh.corner(t, 1), c = mesh.corner(t, 2);
      sum += tiles_of(samples_in(Box{min(a, min(b, c)), max(a, max(b, c))}.grown(reach), grid));
    }
    return sum;
  };
  constexpr std::size_t kGrain = std::size_t{1} << 14;
  return Threads(options.execution.threads).run([&] {
    return std::min(all, tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, mesh.triangles.size(), kGrain), 0.0,
                                              add, std::plus<>()));
  });
}

std::int64_t bytes_needed(std::int64_t triangles, double tiles, const Grid& grid, double thickness,
                          const ComputeOptions& options, bool dense) {
  const BackendRow& backend = find_backend(options.execution.backend, options.method, triangles, grid);
  const double output = dense ? 4.0 * static_cast<double>(grid.sample_count()) * (options.nearest_triangle ? 2 : 1)
                              : field_bytes(tiles, tiles_of(grid.size), options.nearest_triangle);
  const double scratch =
      static_cast<double>(backend.scratch_bytes(triangles, grid, thickness, thread_count(options.execution.threads)));
  const SkipRule rule = effective_rule(options);
  const double kept = rule.kind == SkipRule::Kind::none ? 0 : static_cast<double>(skip_bytes(triangles, rule));
  const double total = output + scratch + kept;
  return total < 0x1p62 ? static_cast<std::int64_t>(total) : std::int64_t{1} << 62;
}

// Requires a valid mesh and grid.
std::int64_t bytes_for_mesh(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                            bool dense) {
  const double tiles = dense ? 0 : tiles_reached(mesh, grid, thickness, options);
  return bytes_needed(static_cast<std::int64_t>(mesh.triangles.size()), tiles, grid, thickness, options, dense);
}

// What may be said to help is what has been seen to help.
class Advice {
 public:
  Advice(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool dense)
      : mesh_(mesh), grid_(grid), thickness_(thickness), options_(options), dense_(dense) {}

  std::string text() const {
    const std::int64_t side = largest_side();
    const std::string fewer = "at most about " + std::to_string(side) + " samples on the longest side";
    const std::string thinner = "a smaller thickness", higher = "a higher limit";
    if (thinner_helps()) return "take " + (side > 0 ? fewer + ", " + thinner + "," : thinner) + " or " + higher;
    return side > 0 ? "take " + fewer + " or " + higher : "give " + higher;
  }

 private:
  bool fits(const Grid& grid, double thickness) const {
    return bytes_for_mesh(mesh_, grid, thickness, options_, dense_) <= options_.memory_limit;
  }

  // A band one sample wide.
  bool thinner_helps() const {
    const double thin = grid_.max_spacing();
    return thin < thickness_ && fits(grid_, thin);
  }

  // Samples on the longest side of a coarser grid of the same extent, or 0. The thickness is taken to be a number of
  // samples, and grows with them: should it stay what it is, the field is smaller still.
  std::int64_t largest_side() const {
    const std::int64_t longest = std::max({grid_.size.x, grid_.size.y, grid_.size.z});
    std::int64_t fitting = 0, too_many = longest;
    while (too_many - fitting > 1 + fitting / 32) {
      const std::int64_t side = fitting + (too_many - fitting) / 2;
      (fits_with(side, longest) ? fitting : too_many) = side;
    }
    return fitting;
  }
  bool fits_with(std::int64_t side, std::int64_t longest) const {
    const double share = static_cast<double>(side) / static_cast<double>(longest);
    Grid coarse = grid_;
    for (std::int64_t* samples : {&coarse.size.x, &coarse.size.y, &coarse.size.z})
      *samples = std::max<std::int64_t>(1, std::llround(share * static_cast<double>(*samples)));
    coarse.spacing = grid_.spacing / Vec3{share, share, share};
    return fits(coarse, thickness_ / share);
  }

  MeshView mesh_;
  const Grid& grid_;
  double thickness_;
  const ComputeOptions& options_;
  bool dense_;
};

}  // namespace

std::int64_t memory_needed(std::int64_t triangles, const Grid& grid, double thickness, const ComputeOptions& options,
                           bool dense) try {
  validate(grid);
  validate(thickness, options);
  if (triangles < 1 || static_cast<std::uint64_t>(triangles) > kMaxTriangles)
    throw Error(triangles < 1 ? ErrorCode::usage : ErrorCode::limit,
                "compute: no mesh has " + std::to_string(triangles) + " triangles; ask for 1 to " +
                    std::to_string(kMaxTriangles));
  return bytes_needed(triangles, tiles_of(grid.size), grid, thickness, options, dense);
} catch (...) {
  throw_as_error("compute");
}

std::int64_t memory_needed(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options,
                           bool dense) try {
  validate(grid);
  validate(thickness, options);
  validate(mesh);
  return bytes_for_mesh(mesh, grid, thickness, options, dense);
} catch (...) {
  throw_as_error("compute");
}

void check_memory(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool dense) {
  const std::int64_t limit = options.memory_limit;
  if (limit == 0) return;
  if (memory_needed(static_cast<std::int64_t>(mesh.triangles.size()), grid, thickness, options, dense) <= limit) return;
  const std::int64_t needed = memory_needed(mesh, grid, thickness, options, dense);
  if (needed <= limit) return;
  throw Error(ErrorCode::limit,
              "compute: the field may need " + over_the_limit(static_cast<double>(needed), static_cast<double>(limit)) +
                  "; " + Advice(mesh, grid, thickness, options, dense).text(),
              {.bytes_needed = needed, .bytes_limit = limit});
}

}  // namespace standoff
