// SPDX-License-Identifier: Apache-2.0
// Marching cubes: counts the vertices and triangles of each block, numbers them, and writes them.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/threads.h"
#include "surface/cells.h"
#include "surface/methods.h"

namespace standoff {
namespace {

// The counts of a block, beside its edges' vertices.
struct CubeCounts {
  std::uint16_t centres = 0, triangles = 0;  // at most 512 cells of 12
};

Vec3 edge_point(const EdgePoints& points, const Neighbourhood& values, int axis, int x, int y, int z) {
  const double t =
      points.crossing(values.value(x, y, z), values.value(x + (axis == 0), y + (axis == 1), z + (axis == 2)));
  return {x + (axis == 0 ? t : 0), y + (axis == 1 ? t : 0), z + (axis == 2 ? t : 0)};
}

// By axis and place: the number of an edge's vertex among the block's vertices, for crossed edges only.
using Ranks = std::array<std::array<std::uint16_t, 512>, 3>;

void emit_vertices(const Block& block, const Neighbourhood& values, const EdgePoints& points, float thickness,
                   Mesh& mesh, Ranks& ranks, SurfaceCounts& counts) {
  Vec3* const vertices = mesh.vertices.data() + block.first_vertex;
  const bool counts_edges = std::isfinite(thickness) || values.leaves_grid();
  std::uint16_t rank = 0;
  for_each_edge(block, [&](int axis, int x, int y, int z) {
    const int x1 = x + (axis == 0), y1 = y + (axis == 1), z1 = z + (axis == 2);
    const float lower = values.value(x, y, z), upper = values.value(x1, y1, z1);
    const double t = points.crossing(lower, upper);
    vertices[rank] = points.at(block.at, {x + (axis == 0 ? t : 0), y + (axis == 1 ? t : 0), z + (axis == 2 ? t : 0)});
    ranks[static_cast<std::size_t>(axis)][static_cast<std::size_t>(x + 8 * (y + 8 * z))] = rank++;
    if (counts_edges)
      counts.count_edge(lower, upper, thickness, !values.is_sample(x, y, z) || !values.is_sample(x1, y1, z1));
  });
}

// The mean of the loop's vertices, moved inside so that it coincides with none of them.
Vec3 centre_point(const EdgePoints& points, const Neighbourhood& values, CellAt cell,
                  std::span<const std::uint8_t> loop) {
  Vec3 sum;
  for (const std::uint8_t edge : loop) {
    const int corner = edge_corner(edge);
    sum = sum + edge_point(points, values, edge_axis(edge), cell.x + (corner & 1), cell.y + (corner >> 1 & 1),
                           cell.z + (corner >> 2));
  }
  const Vec3 lowest{double(cell.x), double(cell.y), double(cell.z)};
  const Vec3 mean = sum * (1.0 / static_cast<double>(loop.size())) - lowest;
  return lowest + Vec3{points.kept(mean.x), points.kept(mean.y), points.kept(mean.z)};
}

}  // namespace

std::int64_t march_cubes(Blocks& blocks, const BlockLayers& layers, const EdgePoints& points, MemoryShare& memory,
                         Mesh& mesh, SurfaceReport& report, ProgressMeter& progress) {
  // Blocks are sorted along z. Those of the next layer are numbered, too.
  const auto first_from = [&](std::int64_t layer) {
    const auto all = std::span<const Block>(blocks.all());
    const auto below = [layer](const Block& block) { return block.at[2] < layer; };
    return static_cast<std::size_t>(std::ranges::partition_point(all, below) - all.begin());
  };
  const BlockRange own{first_from(layers.begin), first_from(layers.end)};
  const BlockRange numbered{own.begin, layers.end == kAllLayers.end ? own.end : first_from(layers.end + 1)};
  const UniformTiles uniform(blocks.field().thickness());
  const auto thickness = static_cast<float>(blocks.field().thickness());
  memory.take(blocks.all().size() * (sizeof(CubeCounts) + sizeof(std::uint64_t)));
  std::vector<CubeCounts> counts(blocks.all().size());
  PerThread<SurfaceCounts> counted;
  for_each_block(blocks, numbered, uniform, progress,
                 [&](std::size_t n, const Block& block, const CornerBits& corners, const Neighbourhood& values) {
                   CubeCounts found;
                   std::int64_t ambiguous = 0;
                   for_each_cell(block, corners, values, points.level(),
                                 [&](CellAt, const CellCase& cell, std::uint32_t faces) {
                                   found.triangles = static_cast<std::uint16_t>(found.triangles + cell.triangle_count);
                                   found.centres = static_cast<std::uint16_t>(found.centres + (cell.centre_loop >= 0));
                                   ambiguous += std::popcount(faces);
                                 });
                   counts[n] = found;
                   if (n < own.end) counted.local().ambiguous += ambiguous;
                 });

  std::uint64_t vertices = mesh.vertices.size(), triangles = mesh.triangles.size();
  std::vector<std::uint64_t> first_triangle(counts.size());
  std::uint64_t own_vertices = vertices, own_triangles = triangles;
  for (std::size_t n = numbered.begin; n < numbered.end; ++n) {
    Block& block = blocks.all()[n];
    expect_countable(vertices);
    block.first_vertex = static_cast<std::uint32_t>(vertices);
    vertices += block.edge_count + std::uint64_t{counts[n].centres};
    first_triangle[n] = triangles;
    triangles += counts[n].triangles;
    if (n < own.end) own_vertices = vertices, own_triangles = triangles;
  }
  expect_countable(vertices);
  grow(mesh, own_vertices, own_triangles, memory.budget());

  for_each_block(
      blocks, own, uniform, progress,
      [&](std::size_t n, const Block& block, const CornerBits& corners, const Neighbourhood& values) {
        Ranks ranks;
        emit_vertices(block, values, points, thickness, mesh, ranks, counted.local());
        const auto upwards = blocks.beside(block, 1);
        Triangle* triangle = mesh.triangles.data() + first_triangle[n];
        std::uint32_t next_centre = block.first_vertex + block.edge_count;
        std::array<std::uint32_t, kCellEdges + 1> vertex;
        for_each_cell(block, corners, values, points.level(), [&](CellAt at, const CellCase& cell, std::uint32_t) {
          std::size_t edges = 0;
          for (int loop = 0; loop < cell.loop_count; ++loop) edges += cell.loop_size[static_cast<std::size_t>(loop)];
          for (std::size_t e = 0; e < edges; ++e) {
            const int edge = cell.loop_edges[e], corner = edge_corner(edge);
            const int x = at.x + (corner & 1), y = at.y + (corner >> 1 & 1), z = at.z + (corner >> 2);
            const int axis = edge_axis(edge), owner = (x >> 3) + 2 * (y >> 3) + 4 * (z >> 3);
            vertex[static_cast<std::size_t>(edge)] =
                owner == 0 ? block.first_vertex +
                                 ranks[static_cast<std::size_t>(axis)][static_cast<std::size_t>(x + 8 * (y + 8 * z))]
                           : upwards[static_cast<std::size_t>(owner)]->vertex(axis, x & 7, y & 7, z & 7);
          }
          if (cell.centre_loop >= 0) {
            mesh.vertices[next_centre] =
                points.at(block.at, centre_point(points, values, at, cell.loop(cell.centre_loop)));
            vertex[CellCase::kCentre] = next_centre++;
          }
          for (int t = 0; t < cell.triangle_count; ++t) {
            const auto& corner = cell.triangles[static_cast<std::size_t>(t)];
            *triangle++ = {vertex[corner[0]], vertex[corner[1]], vertex[corner[2]]};
          }
        });
      });
  std::int64_t ambiguous = 0;
  counted.for_each([&](const SurfaceCounts& one) {
    one.add_to(report);
    ambiguous += one.ambiguous;
  });
  return ambiguous;
}

}  // namespace standoff
