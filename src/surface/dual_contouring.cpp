// SPDX-License-Identifier: Apache-2.0
#include "surface/dual_contouring.h"

#include <algorithm>
#include <array>
#include <vector>

#include "core/threads.h"
#include "surface/cells.h"
#include "surface/dual_cells.h"
#include "surface/dual_polygons.h"
#include "surface/each_block.h"
#include "surface/qef.h"
#include "surface/surface_counts.h"

namespace standoff {
namespace {

// What a block adds to the surface, beside its loops' vertices.
struct ContourCounts {
  std::uint32_t triangles = 0;
  std::uint16_t fans = 0;  // vertices on edges
};

class DualContouring {
 public:
  DualContouring(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory, Mesh& mesh,
                 ProgressMeter& progress)
      : blocks_(blocks),
        points_(points),
        tolerance_(source.tolerance),
        memory_(memory),
        mesh_(mesh),
        progress_(progress),
        uniform_(blocks.field().thickness()),
        hermite_(number_edges()),
        cells_(blocks, uniform_, points.level(), mesh.vertices.size(), progress) {
    memory_.take(cells_.memory_bytes());
    source.fill(blocks, points, hermite_, memory_.budget(), progress);
  }

  void run(IsoReport& report) {
    grow(mesh_, cells_.end(), mesh_.triangles.size(), memory_.budget());
    place_vertices(report);
    count();
    emit();
    report.ambiguous_faces += cells_.ambiguous_faces();
  }

 private:
  std::vector<HermitePoint> number_edges() {
    std::uint64_t edges = 0;
    for (Block& block : blocks_.all()) {
      expect_countable(edges);
      block.first_vertex = static_cast<std::uint32_t>(edges);
      edges += block.edge_count;
    }
    expect_countable(edges);
    constexpr std::size_t kPerBlock = sizeof(std::uint32_t) + sizeof(ContourCounts) + sizeof(std::uint64_t);
    memory_.take(edges * (sizeof(HermitePoint) + sizeof(Cut)) + blocks_.all().size() * kPerBlock);
    return std::vector<HermitePoint>(edges);
  }

  template <class Use>
  void each_block(const Use& use) {
    for_each_block(blocks_, uniform_, progress_, use);
  }

  // Where an edge of the grid is crossed, in spacings from the block's first sample.
  Vec3 crossing(const std::array<const Block*, 8>& beside, int axis, int x, int y, int z) const {
    const Block* const owner = beside[static_cast<std::size_t>((x >> 3) + 2 * (y >> 3) + 4 * (z >> 3))];
    const double t = points_.kept(hermite_[owner->vertex(axis, x & 7, y & 7, z & 7)].t);
    return {x + (axis == 0 ? t : 0), y + (axis == 1 ? t : 0), z + (axis == 2 ? t : 0)};
  }
  Vec3 crossing(const std::array<const Block*, 8>& beside, CellAt at, int edge) const {
    const int corner = edge_corner(edge);
    return crossing(beside, edge_axis(edge), at.x + (corner & 1), at.y + (corner >> 1 & 1), at.z + (corner >> 2));
  }
  Vec3 normal(const std::array<const Block*, 8>& beside, CellAt at, int edge) const {
    const int corner = edge_corner(edge);
    const int x = at.x + (corner & 1), y = at.y + (corner >> 1 & 1), z = at.z + (corner >> 2);
    const Block* const owner = beside[static_cast<std::size_t>((x >> 3) + 2 * (y >> 3) + 4 * (z >> 3))];
    return hermite_[owner->vertex(edge_axis(edge), x & 7, y & 7, z & 7)].normal();
  }

  // The loop's vertex, in spacings from the block's first sample.
  Vec3 loop_point(const std::array<const Block*, 8>& beside, CellAt at, std::span<const std::uint8_t> loop,
                  bool mean) const {
    const Vec3 unit = blocks_.field().grid().spacing * (1 / blocks_.field().grid().max_spacing());
    const Vec3 lowest{double(at.x), double(at.y), double(at.z)};
    PlaneFit fit;
    for (const std::uint8_t edge : loop)
      fit.add((crossing(beside, at, edge) - lowest) * unit, normal(beside, at, edge));
    const Vec3 least = Vec3{1, 1, 1} * points_.clearance(), most = Vec3{1, 1, 1} - least;
    const Vec3 found = (mean ? fit.mass_point() : fit.minimum({least * unit, most * unit}, tolerance_)) / unit;
    return lowest + min(max(found, least), most);
  }

  void place_vertices(IsoReport& report) {
    const auto thickness = static_cast<float>(blocks_.field().thickness());
    PerThread<SurfaceCounts> counted;
    each_block([&](std::size_t, const Block& block, const CornerBits& corners, const Neighbourhood& values) {
      const auto beside = blocks_.beside(block, 1);
      for_each_cell(block, corners, values, points_.level(), [&](CellAt at, const CellCase& found, std::uint32_t) {
        const CellOf cell{&block, at.x, at.y, at.z};
        const SpecialCell* const special = found.loop_count > 1 ? cells_.special(cell) : nullptr;
        for (int loop = 0; loop < found.loop_count; ++loop) {
          Vec3& vertex = mesh_.vertices[cells_.vertex_of_loop(cell, special, loop)];
          // Where several pieces pass through a cell, the means of their crossings keep them apart.
          vertex = points_.at(block.at, loop_point(beside, at, found.loop(loop), found.loop_count > 1));
          // Two loops with the same vertex: this one moves, from its mean towards a point of its own.
          const Vec3 own = Vec3{at.x + 0.3 + 0.1 * loop, at.y + 0.4, at.z + 0.6};
          constexpr int kSteps = 16;
          for (int step = 0, other = 0; other < loop && step <= kSteps;) {
            if (mesh_.vertices[cells_.vertex_of_loop(cell, special, other++)] != vertex) continue;
            const Vec3 mean = loop_point(beside, at, found.loop(loop), true);
            vertex = points_.at(block.at, mean + (own - mean) * (step++ * (1.0 / kSteps)));
            other = 0;
          }
        }
      });
      for_each_edge(block, [&](int axis, int x, int y, int z) {
        const int x1 = x + (axis == 0), y1 = y + (axis == 1), z1 = z + (axis == 2);
        counted.local().count_edge(values.value(x, y, z), values.value(x1, y1, z1), thickness,
                                   !values.is_sample(x, y, z) || !values.is_sample(x1, y1, z1));
      });
    });
    counted.for_each([&](const SurfaceCounts& one) { one.add_to(report); });
  }

  Cut cut(const Block& block, int axis, int x, int y, int z, const DualPolygon& polygon) const {
    if (polygon.has_more()) return Cut::fan;
    const Grid& grid = blocks_.field().grid();
    const Vec3 lower =
        grid.origin + grid.spacing * Vec3{8.0 * block.at[0] + x, 8.0 * block.at[1] + y, 8.0 * block.at[2] + z};
    std::array<Vec3, 4> corner;
    for (std::size_t n = 0; n < 4; ++n) {
      const Vec3 p = (mesh_.vertices[polygon.vertices[n]] - lower) / grid.spacing;
      corner[n] = axis == 0 ? Vec3{p.y, p.z, p.x} : axis == 1 ? Vec3{p.z, p.x, p.y} : p;
    }
    return cut_of(corner);
  }

  // Calls use(axis, x, y, z, polygon) for each crossed edge of a block.
  template <class Use>
  void for_each_polygon(const Block& block, const CornerBits& corners, const Use& use) const {
    const DualPolygons polygons(blocks_, cells_, block, first_face_);
    for_each_edge(block, [&](int axis, int x, int y, int z) {
      const bool up = (corners.layers[static_cast<std::size_t>(z)][0] >> (x + 8 * y) & 1) != 0;
      use(axis, x, y, z, polygons.around(axis, x, y, z, up));
    });
  }

  void count() {
    const std::size_t blocks = blocks_.all().size();
    first_face_.resize(blocks);
    counts_.resize(blocks);
    cuts_.resize(hermite_.size());
    each_block([&](std::size_t n, const Block& block, const CornerBits& corners, const Neighbourhood&) {
      Cut* next = cuts_.data() + block.first_vertex;
      for_each_polygon(block, corners, [&](int axis, int x, int y, int z, const DualPolygon& polygon) {
        *next = cut(block, axis, x, y, z, polygon);
        counts_[n].fans = static_cast<std::uint16_t>(counts_[n].fans + (*next == Cut::fan));
        counts_[n].triangles += *next == Cut::fan ? static_cast<std::uint32_t>(polygon.size) : 2;
        ++next;
      });
    });
  }

  void emit() {
    std::uint64_t vertices = mesh_.vertices.size(), triangles = mesh_.triangles.size();
    std::vector<std::uint64_t> first_triangle(counts_.size());
    for (std::size_t n = 0; n < counts_.size(); ++n) {
      expect_countable(vertices);
      first_face_[n] = static_cast<std::uint32_t>(vertices);
      vertices += 2 * cells_.doubled(blocks_.all()[n]).size() + counts_[n].fans;
      first_triangle[n] = triangles;
      triangles += counts_[n].triangles;
    }
    expect_countable(vertices);
    grow(mesh_, vertices, triangles, memory_.budget());
    each_block([&](std::size_t n, const Block& block, const CornerBits& corners, const Neighbourhood&) {
      const auto beside = blocks_.beside(block, 1);
      std::uint32_t next_vertex = first_face_[n];
      for (const DoubledFace& face : cells_.doubled(block))
        for (const Vec3 point : face_points(beside, block, face))
          mesh_.vertices[next_vertex++] = points_.at(block.at, point);
      Triangle* triangle = mesh_.triangles.data() + first_triangle[n];
      const Cut* next = cuts_.data() + block.first_vertex;
      for_each_polygon(block, corners, [&](int axis, int x, int y, int z, const DualPolygon& polygon) {
        const auto& v = polygon.vertices;
        switch (*next++) {
          case Cut::first:
            *triangle++ = {v[0], v[1], v[2]};
            *triangle++ = {v[0], v[2], v[3]};
            return;
          case Cut::second:
            *triangle++ = {v[1], v[2], v[3]};
            *triangle++ = {v[1], v[3], v[0]};
            return;
          case Cut::fan:
            mesh_.vertices[next_vertex] = points_.at(block.at, crossing(beside, axis, x, y, z));
            for (int k = 0; k < polygon.size; ++k)
              *triangle++ = {v[static_cast<std::size_t>(k)], v[static_cast<std::size_t>((k + 1) % polygon.size)],
                             next_vertex};
            ++next_vertex;
        }
      });
    });
  }

  // The middles of the two segments of a doubled face, that with its lowest edge first.
  std::array<Vec3, 2> face_points(const std::array<const Block*, 8>& beside, const Block& block,
                                  const DoubledFace& doubled) const {
    const CellAt at{doubled.cell & 7, doubled.cell >> 3 & 7, doubled.cell >> 6};
    const CellCase& found = *cells_.special({&block, at.x, at.y, at.z})->found;
    const int face = 2 * doubled.axis + 1, first = first_edge_of(face), second = segment_end(found, first, face);
    int third = first;
    while (third == first || third == second || (edge_faces(third) >> face & 1) == 0) ++third;
    const int fourth = segment_end(found, third, face);
    return {(crossing(beside, at, first) + crossing(beside, at, second)) * 0.5,
            (crossing(beside, at, third) + crossing(beside, at, fourth)) * 0.5};
  }

  Blocks& blocks_;
  const EdgePoints& points_;
  double tolerance_;
  MemoryShare& memory_;
  Mesh& mesh_;
  ProgressMeter& progress_;
  UniformTiles uniform_;
  std::vector<HermitePoint> hermite_;  // by edge: Block::vertex()
  DualCells cells_;
  std::vector<std::uint32_t> first_face_;  // by block: the first of its vertices on faces; those on edges follow
  std::vector<ContourCounts> counts_;
  std::vector<Cut> cuts_;  // by edge
};

}  // namespace

void contour_dually(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory,
                    Mesh& mesh, IsoReport& report, ProgressMeter& progress) {
  DualContouring(blocks, points, source, memory, mesh, progress).run(report);
}

}  // namespace standoff
