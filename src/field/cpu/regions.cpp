// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/regions.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "field/tolerances.h"

namespace standoff::cpu {
namespace {

// Vertices with more triangles count as open: their triangles are compared one with another.
constexpr std::uint32_t kMostAround = 32;

// What rounding may take from the cosine of an angle between unit vectors in float.
constexpr float kCosineSlack = 1e-6f;
static_assert(kCosineSlack > gamma_float(8));

// The angle by which a triangle's frame may be turned against the triangle, in radians (docs/tiles.md).
constexpr float kTurned = 1e-3f;

// The least of all steps, so that frames turn no more than that. Grid units.
constexpr float kLeastStep = 0.05f;

// A guess: triangles around a corner are bent so many times as much as two of them; and a tilt where that is unknown.
// Decide time alone.
constexpr float kTiltOfBend = 3, kUsualTilt = 0.25f;

// With regions for fewer triangles than one of so many, none is worth it.
constexpr std::int64_t kLeastShare = 8;

// The corners of all triangles are counted in 32 bits.
constexpr std::int64_t kMostTriangles = std::int64_t{1} << 30;

using Normal = Triple<float>;
Normal unit(const Vec3& v) {
  const double length_sq = dot(v, v), inverse = length_sq > 0 ? 1 / std::sqrt(length_sq) : 0;
  return {static_cast<float>(v.x * inverse), static_cast<float>(v.y * inverse), static_cast<float>(v.z * inverse)};
}

// Regions are for jobs of nearly all triangles of a mesh: of at most so many.
std::int64_t most_region_triangles(std::int64_t triangles) { return triangles + triangles / 4; }

// How far one can go from a region's triangle into each neighbour, and the least that one comes nearer to a left-out
// sample for each step: squared, more than the errors of two distances (docs/tiles.md). Grid units.
float region_step(const Lattice& lattice) {
  double half_sq = 0;
  for (const double unit : lattice.unit) half_sq += unit * unit * (kBrickSide - 1) * (kBrickSide - 1) / 4;
  const double farthest = std::sqrt(half_sq) + lattice.thickness_units + std::sqrt(3.0) * kLongestWithRegion;
  const double error = kFrameError * farthest + 1e-5;
  return std::max(kLeastStep, static_cast<float>(1.001 * std::sqrt(4 * error * (lattice.thickness_units + error))));
}

// region_slack() for this step.
float slack_of(float step) { return step / kLeastSine + kSlack; }

// The unit normal of the job's n-th triangle if that is large, small and round enough to bound regions; else 0.
Normal normal_of(const Job& job, const Lattice& lattice, float step, std::int64_t n) {
  const auto [a, b, c] = job.mesh.corners(job.triangle(n));
  const Vec3 u = (b - a) * lattice.scale, v = (c - a) * lattice.scale, w = v - u, across = cross(u, v);
  if (std::max({max_norm(u), max_norm(v), max_norm(w)}) > kLongestWithRegion) return {};
  const double edges[3] = {dot(u, u), dot(v, v), dot(w, w)}, area_sq = dot(across, across);
  const auto [least, most] = std::ranges::minmax(edges);
  const double middle = edges[0] + edges[1] + edges[2] - least - most;
  const bool is_usable =
      area_sq >= double{step} * step * most && area_sq >= double{kLeastSine} * kLeastSine * most * middle;
  return is_usable ? unit(across) : Normal{};
}

// The region of a triangle with this unit normal.
Region region_of(const Normal& normal, float tilt, const Lattice& lattice, float slack) {
  const float all = lattice.thickness + kSlack;
  Region region{tilt, {all, all, all}};
  if (tilt == kNoTilt) return region;
  // A point of the region, seen from the triangle's nearest point, is within the angle of the normal but for the slack.
  const float cosine = 1 / std::sqrt(1 + tilt * tilt), along[3] = {normal.x, normal.y, normal.z};
  for (int axis = 0; axis < 3; ++axis) {
    const float a = std::abs(along[axis]), across = std::sqrt(std::max(0.0f, 1 - a * a));
    if (a < cosine) region.reach[axis] = std::min(all, lattice.thickness * cosine * (a + tilt * across) + slack);
  }
  return region;
}

// An axis from which no normal around a vertex is farther than an angle. The cosine is 0 or less if the vertex is not
// closed.
struct Around {
  Normal axis;
  float cosine = 0;
};

class Finding {
 public:
  Finding(const Job& job, const Lattice& lattice)
      : job_(job),
        lattice_(lattice),
        step_(region_step(lattice)),
        normals_(static_cast<std::size_t>(job.triangle_count())),
        around_(job.mesh.vertices.size()) {}

  Regions find() {
    const std::int64_t parts = std::min<std::int64_t>(job_.threads, job_.triangle_count());
    const auto in_parts = [&](std::int64_t all, auto use) {
      tbb::parallel_for(std::int64_t{0}, parts, [&, all](std::int64_t part) {
        job_.progress.check();
        use(all * part / parts, all * (part + 1) / parts);
      });
    };
    in_parts(job_.triangle_count(), [&](std::int64_t first, std::int64_t end) {
      for (std::int64_t n = first; n < end; ++n)
        normals_[static_cast<std::size_t>(n)] = normal_of(job_, lattice_, step_, n);
    });
    in_parts(static_cast<std::int64_t>(around_.size()),
             [&](std::int64_t first, std::int64_t end) { look_around(first, end); });
    const float slack = slack_of(step_);
    Regions regions(job_.mesh.triangles.size());
    in_parts(job_.triangle_count(), [&](std::int64_t first, std::int64_t end) {
      for (std::int64_t n = first; n < end; ++n)
        regions[job_.triangle(n)] = region_of(normals_[static_cast<std::size_t>(n)], tilt(n), lattice_, slack);
    });
    return regions;
  }

 private:
  // Sorts the corners of triangles by vertex, for vertices first to end - 1.
  void look_around(std::int64_t first_vertex, std::int64_t end_vertex) {
    const auto first = static_cast<std::uint32_t>(first_vertex),
               count = static_cast<std::uint32_t>(end_vertex - first_vertex);
    std::vector<std::uint32_t> start(std::size_t{count} + 2);
    const auto for_each_corner = [&](auto use) {
      for (std::int64_t n = 0; n < job_.triangle_count(); ++n)
        for (const std::uint32_t vertex : job_.mesh.triangles[job_.triangle(n)])
          if (vertex - first < count) use(vertex - first, static_cast<std::uint32_t>(n));
    };
    for_each_corner([&](std::uint32_t vertex, std::uint32_t) { ++start[vertex + 2]; });
    for (std::uint32_t vertex = 0; vertex < count; ++vertex) start[vertex + 2] += start[vertex + 1];
    std::vector<std::uint32_t> triangles(start.back());
    for_each_corner([&](std::uint32_t vertex, std::uint32_t n) { triangles[start[vertex + 1]++] = n; });
    for (std::uint32_t vertex = 0; vertex < count; ++vertex)
      around_[first + vertex] =
          around(first + vertex, {triangles.data() + start[vertex], start[vertex + 1] - start[vertex]});
  }

  Around around(std::uint32_t vertex, std::span<const std::uint32_t> triangles) const {
    if (triangles.size() > kMostAround) return {};
    std::uint32_t next[kMostAround], last[kMostAround];
    Vec3 sum{};
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      const auto [a, b, c] = job_.mesh.triangles[job_.triangle(triangles[k])];
      next[k] = vertex == a ? b : vertex == b ? c : a;
      last[k] = vertex == a ? c : vertex == b ? a : b;
      const Normal& normal = normals_[triangles[k]];
      sum = sum + Vec3{normal.x, normal.y, normal.z};
    }
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      bool goes_on = false;
      for (std::size_t j = 0; j < triangles.size(); ++j) goes_on |= next[j] == last[k];
      if (!goes_on) return {};
    }
    Around all{unit(sum), 1};
    for (const std::uint32_t n : triangles) all.cosine = std::min(all.cosine, dot(all.axis, normals_[n]));
    all.cosine -= kCosineSlack;
    return all;
  }

  float tilt(std::int64_t n) const {
    const Normal& normal = normals_[static_cast<std::size_t>(n)];
    float most = 0;
    for (const std::uint32_t vertex : job_.mesh.triangles[job_.triangle(n)]) {
      const Around& all = around_[vertex];
      // The sum of two angles: from the normal to the axis, and from there to the farthest normal.
      const float a = dot(normal, all.axis) - kCosineSlack, b = all.cosine;
      if (!(a > 0 && b > 0)) return kNoTilt;
      const float sine_a = std::sqrt(1 - a * a), sine_b = std::sqrt(1 - b * b), cosine = a * b - sine_a * sine_b,
                  sine = sine_a * b + a * sine_b;
      if (!(sine <= kMostTilt * cosine)) return kNoTilt;
      most = std::max(most, sine / cosine);
    }
    return most + 1.1f * kTurned * (1 + most * most);
  }

  const Job& job_;
  const Lattice& lattice_;
  const float step_;
  std::vector<Normal> normals_;  // by number in the job
  std::vector<Around> around_;   // by vertex
};

}  // namespace

Region guessed_region(const Job& job, const Lattice& lattice, std::int64_t n) {
  const float step = region_step(lattice);
  const std::int64_t next = std::min(n + 1, job.triangle_count() - 1);
  const Normal here = normal_of(job, lattice, step, n), there = normal_of(job, lattice, step, next);
  const Triangle mine = job.mesh.triangles[job.triangle(n)], others = job.mesh.triangles[job.triangle(next)];
  const bool are_neighbours = next != n && std::ranges::find_first_of(mine, others) != mine.end();
  const float cosine = dot(here, there), bend = std::sqrt(std::max(0.0f, 1 - cosine * cosine)) / cosine;
  float tilt = kUsualTilt;
  if (are_neighbours) tilt = cosine > 0 && kTiltOfBend * bend <= kMostTilt ? kTiltOfBend * bend : kNoTilt;
  return region_of(here, dot(here, here) > 0 ? tilt : kNoTilt, lattice, slack_of(step));
}

float region_slack(const Lattice& lattice) { return slack_of(region_step(lattice)); }

std::int64_t regions_bytes(std::int64_t triangles) {
  return most_region_triangles(triangles) * static_cast<std::int64_t>(sizeof(Region));
}

std::int64_t regions_scratch_bytes(std::int64_t triangles, int threads) {
  // Beside normals and vertices, the sorted triangles around the vertices, or the regions.
  const std::int64_t sorted =
      (triangles + 2 * threads + 3 * triangles) * static_cast<std::int64_t>(sizeof(std::uint32_t));
  return triangles * static_cast<std::int64_t>(sizeof(Normal) + sizeof(Around)) +
         std::max(sorted, regions_bytes(triangles));
}

Regions find_regions(const Job& job, const Lattice& lattice) {
  // Where few triangles share vertices, few neighbours would be found.
  const std::int64_t count = job.triangle_count();
  if (count > kMostTriangles || static_cast<std::int64_t>(job.mesh.vertices.size()) > count ||
      static_cast<std::int64_t>(job.mesh.triangles.size()) > most_region_triangles(count))
    return {};
  Regions regions = Finding(job, lattice).find();
  const auto bounded = std::ranges::count_if(regions, [](const Region& region) { return region.tilt < kNoTilt; });
  if (bounded < job.triangle_count() / kLeastShare) return {};
  return regions;
}

}  // namespace standoff::cpu
