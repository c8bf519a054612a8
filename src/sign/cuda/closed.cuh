// SPDX-License-Identifier: Apache-2.0
// Whether a mesh in device memory is closed and faces outwards, by the sums of diagnosis/closed.cpp. The sum that tells
// whether it is closed is one of integers, the same in any order. The sums of a part, the triangles that share
// vertices, are rounded in another order each time. So a part that is near to a threshold is left to the CPU.
#pragma once

#include <algorithm>
#include <cstdint>

#include "gpu/mesh.cuh"
#include "gpu/platform.cuh"
#include "gpu/warp.cuh"
#include "sign/diagnosis/closed_terms.h"

namespace standoff::STANDOFF_PLATFORM {

inline constexpr unsigned kClosedThreads = 256;
/// The most parts of a mesh.
inline constexpr std::uint32_t kMostMeshParts = 1 << 16;

/// What the passes over a mesh leave behind, in device memory.
struct MeshParts {
  struct Totals {
    Counter area;
    std::uint32_t parts, with_area;
  };
  static constexpr std::uint32_t kNoNumber = 0xffffffffu;

  Totals* totals;
  OutwardTerms* sums;     // of a part, most_parts
  std::uint32_t* link;    // of a vertex: a lower vertex of the same part, or itself
  std::uint32_t* number;  // of a part, at its lowest vertex
  std::int64_t most_parts;

  /// `joins`: whether parts are wanted.
  MeshParts(gpu::Workspace& memory, const DeviceMesh& mesh, bool joins)
      : totals(memory.take<Totals>(1)),
        most_parts(joins ? std::min<std::int64_t>(kMostMeshParts, mesh.triangle_count) : 0) {
    const std::int64_t vertices = joins ? mesh.vertex_count : 0;
    sums = memory.take<OutwardTerms>(most_parts);
    link = memory.take<std::uint32_t>(vertices);
    number = memory.take<std::uint32_t>(vertices);
  }
};

STANDOFF_DEVICE Vec3 vec_at(const DeviceMesh& mesh, std::int64_t vertex) { return vec_of(vertex_of(mesh, vertex)); }

// Links lead to lower vertices, and so to the lowest one of a part in the end, whatever the order of the threads.

STANDOFF_DEVICE std::uint32_t find_part(std::uint32_t* link, std::uint32_t vertex) {
  for (;;) {
    const std::uint32_t up = load_relaxed(&link[vertex]);
    if (up == vertex) return vertex;
    const std::uint32_t above = load_relaxed(&link[up]);
    if (above != up) atomicMin(&link[vertex], above);  // halves the path
    vertex = above;
  }
}

STANDOFF_DEVICE void join(std::uint32_t* link, std::uint32_t a, std::uint32_t b) {
  for (;;) {
    a = find_part(link, a);
    b = find_part(link, b);
    if (a == b) return;
    const std::uint32_t low = a < b ? a : b, high = a < b ? b : a;
    if (atomicCAS(&link[high], high, low) == high) return;
  }
}

/// Each vertex is a part. Threads stride over the vertices.
STANDOFF_KERNEL void begin_parts(MeshParts parts, std::int64_t vertices) {
  for (std::int64_t v = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; v < vertices;
       v += std::int64_t{blockDim.x} * gridDim.x) {
    parts.link[v] = static_cast<std::uint32_t>(v);
    parts.number[v] = MeshParts::kNoNumber;
  }
}

/// Adds up the areas of the triangles in the plane of random places, and, if `joins`, joins the parts of their corners.
/// Threads stride over the triangles. Invalid triangles are noted in the outcome.
STANDOFF_KERNEL void sum_areas(DeviceMesh mesh, MeshParts parts, bool joins, Outcome* outcome) {
  Counter area = 0;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < mesh.triangle_count;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    const auto triangle = static_cast<std::uint32_t>(n);
    if (!is_valid(mesh, triangle, outcome)) continue;
    const std::uint32_t a = vertex_index(mesh, triangle, 0), b = vertex_index(mesh, triangle, 1),
                        c = vertex_index(mesh, triangle, 2);
    area += twice_area(place_of(vec_at(mesh, a)), place_of(vec_at(mesh, b)), place_of(vec_at(mesh, c)));
    if (!joins) continue;
    join(parts.link, a, b);
    join(parts.link, b, c);
  }
  area = warp_sum(area);
  if (threadIdx.x % 32 == 0) atomicAdd(&parts.totals->area, area);
}

/// Links each vertex to the lowest one of its part. Threads stride over the vertices.
STANDOFF_KERNEL void follow_links(MeshParts parts, std::int64_t vertices, const Outcome* outcome) {
  if (outcome->stopped != 0) return;
  for (std::int64_t v = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; v < vertices;
       v += std::int64_t{blockDim.x} * gridDim.x)
    atomicMin(&parts.link[v], find_part(parts.link, static_cast<std::uint32_t>(v)));
}

/// Gives numbers to the parts that have triangles. Threads stride over the triangles.
STANDOFF_KERNEL void number_parts(DeviceMesh mesh, MeshParts parts, const Outcome* outcome) {
  if (outcome->stopped != 0) return;
  for (std::int64_t n = std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x; n < mesh.triangle_count;
       n += std::int64_t{blockDim.x} * gridDim.x) {
    std::uint32_t* const number = &parts.number[parts.link[vertex_index(mesh, static_cast<std::uint32_t>(n), 0)]];
    // The thread that takes the part gives it a number, which others read in the next pass.
    if (load_relaxed(number) == MeshParts::kNoNumber &&
        atomicCAS(number, MeshParts::kNoNumber, 0u) == MeshParts::kNoNumber)
      atomicAdd(number, atomicAdd(&parts.totals->parts, 1u));
  }
}

STANDOFF_DEVICE void add_to(OutwardTerms* to, const OutwardTerms& more) {
  atomicAdd(&to->volume, more.volume);
  atomicAdd(&to->volume_magnitude, more.volume_magnitude);
  atomicAdd(&to->normal.x, more.normal.x);
  atomicAdd(&to->normal.y, more.normal.y);
  atomicAdd(&to->normal.z, more.normal.z);
  atomicAdd(&to->normal_magnitude, more.normal_magnitude);
}

/// Adds up the terms of each part. A warp goes through triangles side by side, most of which belong to one part, and
/// adds its sums together where they all do.
STANDOFF_KERNEL void sum_parts(DeviceMesh mesh, MeshParts parts, const Outcome* outcome) {
  if (outcome->stopped != 0 || parts.totals->parts > kMostMeshParts) return;
  const std::int64_t warps = std::int64_t{gridDim.x} * (blockDim.x / 32),
                     warp = (std::int64_t{blockIdx.x} * blockDim.x + threadIdx.x) / 32,
                     each = (mesh.triangle_count + 32 * warps - 1) / (32 * warps) * 32, begin = warp * each,
                     end = begin + each < mesh.triangle_count ? begin + each : mesh.triangle_count;
  std::uint32_t part = MeshParts::kNoNumber;
  OutwardTerms sums;
  for (std::int64_t n = begin + threadIdx.x % 32; n < end; n += 32) {
    const auto triangle = static_cast<std::uint32_t>(n);
    const std::uint32_t lowest = parts.link[vertex_index(mesh, triangle, 0)], own = parts.number[lowest];
    if (own != part) {
      if (part != MeshParts::kNoNumber) add_to(&parts.sums[part], sums);
      part = own;
      sums = {};
    }
    const Corners c = corners_of(mesh, triangle);
    sums.add(OutwardTerms::of(vec_of(c.at[0]), vec_of(c.at[1]), vec_of(c.at[2]), vec_at(mesh, lowest)));
  }
  const std::uint32_t first = __shfl_sync(0xffffffffu, part, 0);
  if (__ballot_sync(0xffffffffu, part == first) == 0xffffffffu) {
    sums = {warp_sum(sums.volume),
            warp_sum(sums.volume_magnitude),
            {warp_sum(sums.normal.x), warp_sum(sums.normal.y), warp_sum(sums.normal.z)},
            warp_sum(sums.normal_magnitude)};
    if (threadIdx.x % 32 != 0) return;
  }
  if (part != MeshParts::kNoNumber) add_to(&parts.sums[part], sums);
}

/// Notes the doubts that the sums leave. `joins`: whether parts were summed. One block.
STANDOFF_KERNEL void judge_parts(MeshParts parts, bool joins, Outcome* outcome) {
  if (outcome->stopped != 0) return;
  const std::uint32_t count = parts.totals->parts;
  for (std::uint32_t n = threadIdx.x; joins && n < count && count <= kMostMeshParts; n += blockDim.x) {
    if (parts.sums[n].has_area()) atomicOr(&parts.totals->with_area, 1u);
    if (!parts.sums[n].surely_faces_outwards()) atomicOr(&outcome->doubts, Counter{Outcome::kNotOutwards});
  }
  __syncthreads();
  if (threadIdx.x != 0) return;
  if (parts.totals->area != 0) atomicOr(&outcome->doubts, Counter{Outcome::kOpen});
  if (joins && (count > kMostMeshParts || parts.totals->with_area == 0))
    atomicOr(&outcome->doubts, Counter{Outcome::kNotOutwards});
}

/// Launches all of it. `as_oriented`: whether it does not matter which way the parts face.
inline void enqueue_closed(const DeviceMesh& mesh, const MeshParts& parts, bool as_oriented, Outcome* outcome,
                           Stream stream) {
  const auto blocks = [](std::int64_t items) {
    return std::min<std::int64_t>(kManyBlocks, (items + kClosedThreads - 1) / kClosedThreads);
  };
  const std::int64_t of_vertices = blocks(std::max<std::int64_t>(1, mesh.vertex_count)),
                     of_triangles = blocks(mesh.triangle_count);
  fill_bytes(stream, parts.totals, 0, sizeof(MeshParts::Totals));
  if (!as_oriented) launch(stream, "begin parts", begin_parts, of_vertices, kClosedThreads, parts, mesh.vertex_count);
  launch(stream, "sum areas", sum_areas, of_triangles, kClosedThreads, mesh, parts, !as_oriented, outcome);
  if (!as_oriented) {
    fill_bytes(stream, parts.sums, 0, parts.most_parts * static_cast<std::int64_t>(sizeof(OutwardTerms)));
    launch(stream, "follow links", follow_links, of_vertices, kClosedThreads, parts, mesh.vertex_count, outcome);
    launch(stream, "number parts", number_parts, of_triangles, kClosedThreads, mesh, parts, outcome);
    launch(stream, "sum parts", sum_parts, of_triangles, kClosedThreads, mesh, parts, outcome);
  }
  launch(stream, "judge parts", judge_parts, 1, kClosedThreads, parts, !as_oriented, outcome);
}

}  // namespace standoff::STANDOFF_PLATFORM
