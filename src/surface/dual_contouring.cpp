// SPDX-License-Identifier: Apache-2.0
// Dual contouring: places a vertex in each cell by the tangent planes of its loop, then counts, numbers and writes the
// triangles of the polygons.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "core/threads.h"
#include "geometry/symmetric3.h"
#include "standoff/vec.h"
#include "surface/cells.h"
#include "surface/dual_cells.h"
#include "surface/methods.h"
#include "surface/vertices.h"

namespace standoff {
namespace {

// Finds the point of a cell that is nearest to the tangent planes of a loop: it minimises the sum of squared distances
// from the planes added ("Dual contouring of Hermite data", Ju, Losasso, Schaefer, Warren 2002).
class PlaneFit {
 public:
  void add(Vec3 point, Vec3 normal);
  // The mean of the points added.
  Vec3 mass_point() const { return sum_ * (1.0 / count_); }
  // The point of the box where the sum is least; if many points are equally good, the one nearest to the mass point.
  // Eigenvalues of the normals' matrix up to `tolerance` times the largest one count as 0: the planes do not determine
  // the point in these directions. Two planes at an angle of a have eigenvalues in the ratio tan(a/2)^2.
  Vec3 minimum(const Box& box, double tolerance) const;

 private:
  std::array<double, 6> normals_{};  // the matrix A^T A: xx xy xz yy yz zz
  Vec3 right_;                       // A^T b, about the first point
  Vec3 first_, sum_, normal_sum_;
  int count_ = 0;
};

using QefRow = std::array<double, 3>;
using Matrix = Matrix3;

QefRow row_of(Vec3 v) { return {v.x, v.y, v.z}; }

// Solves the equations of the free coordinates; the others keep their values. The matrix must be positive definite.
QefRow solve_free(const Matrix& m, const QefRow& right, QefRow x, unsigned free) {
  Matrix a{};
  QefRow b{};
  std::array<std::size_t, 3> index{};
  std::size_t n = 0;
  for (std::size_t i = 0; i < 3; ++i)
    if ((free >> i & 1) != 0) index[n++] = i;
  for (std::size_t i = 0; i < n; ++i) {
    b[i] = right[index[i]];
    for (std::size_t j = 0; j < 3; ++j)
      if ((free >> j & 1) == 0) b[i] -= m[index[i]][j] * x[j];
    for (std::size_t j = 0; j < n; ++j) a[i][j] = m[index[i]][index[j]];
  }
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = i + 1; k < n; ++k) {
      const double factor = a[k][i] / a[i][i];
      for (std::size_t j = i; j < n; ++j) a[k][j] -= factor * a[i][j];
      b[k] -= factor * b[i];
    }
  for (std::size_t i = n; i-- > 0;) {
    double sum = b[i];
    for (std::size_t j = i + 1; j < n; ++j) sum -= a[i][j] * x[index[j]];
    x[index[i]] = sum / a[i][i];
  }
  return x;
}

// The minimum of a positive definite form in a box: the best point in the box among the minima on its inside, faces,
// edges and corners. `x`: coordinates relative to the mass point.
QefRow least_in_box(const Matrix& m, const QefRow& right, const QefRow& low, const QefRow& high) {
  QefRow best{};
  double least = std::numeric_limits<double>::infinity();
  for (unsigned sides = 0; sides < 27; ++sides) {
    QefRow x{};
    unsigned free = 0;
    for (unsigned i = 0, rest = sides; i < 3; ++i, rest /= 3) {
      if (rest % 3 == 0) free |= 1u << i;
      x[i] = rest % 3 == 1 ? low[i] : rest % 3 == 2 ? high[i] : 0;
    }
    x = solve_free(m, right, x, free);
    bool in_box = true;
    double value = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      in_box &= x[i] >= low[i] && x[i] <= high[i];
      value -= 2 * right[i] * x[i];
      for (std::size_t j = 0; j < 3; ++j) value += x[i] * m[i][j] * x[j];
    }
    if (in_box && value < least) {
      least = value;
      best = x;
    }
  }
  return best;
}

void PlaneFit::add(Vec3 point, Vec3 normal) {
  if (count_++ == 0) first_ = point;
  sum_ = sum_ + point;
  normal_sum_ = normal_sum_ + normal;
  const double at = dot(normal, point - first_);
  right_ = right_ + normal * at;
  normals_[0] += normal.x * normal.x;
  normals_[1] += normal.x * normal.y;
  normals_[2] += normal.x * normal.z;
  normals_[3] += normal.y * normal.y;
  normals_[4] += normal.y * normal.z;
  normals_[5] += normal.z * normal.z;
}

Vec3 PlaneFit::minimum(const Box& box, double tolerance) const {
  const Vec3 mass = mass_point();
  const QefRow offset = row_of(mass - first_);
  const auto& a = normals_;
  const Matrix m{{{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}}};
  QefRow right = row_of(right_);  // about the mass point
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) right[i] -= m[i][j] * offset[j];
  // The sum of the two lesser eigenvalues is at most the sum of the squared deviations from the mean normal. If that
  // counts as 0, the planes are parallel, as nearly everywhere on smooth surfaces, and no eigenvalues are needed.
  const double trace = a[0] + a[3] + a[5], along_mean = dot(normal_sum_, normal_sum_) / count_;
  if (trace - along_mean <= tolerance * along_mean) {
    const QefRow direction = row_of(normal_sum_ * (1 / std::sqrt(along_mean * count_)));
    double rise = 0, slope = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      rise += direction[i] * right[i];
      for (std::size_t k = 0; k < 3; ++k) slope += direction[i] * m[i][k] * direction[k];
    }
    const Vec3 found = mass + normal_sum_ * (rise / slope / std::sqrt(along_mean * count_));
    if (max(found, box.min) == found && min(found, box.max) == found) return found;
  }
  Matrix values = m, vectors;
  diagonalise(values, vectors);
  const double largest = std::max({values[0][0], values[1][1], values[2][2]});
  if (!(largest > 0)) return mass;
  QefRow x{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (values[k][k] <= tolerance * largest) continue;
    double along = 0;
    for (std::size_t i = 0; i < 3; ++i) along += vectors[i][k] * right[i];
    for (std::size_t i = 0; i < 3; ++i) x[i] += vectors[i][k] * along / values[k][k];
  }
  const QefRow low = row_of(box.min - mass), high = row_of(box.max - mass);
  bool in_box = true;
  for (std::size_t i = 0; i < 3; ++i) in_box &= x[i] >= low[i] && x[i] <= high[i];
  if (!in_box) {
    // Solve with a weak pull to the mass point in place of the tolerance, so that there is one minimum in the box.
    constexpr double kPull = 0.01;
    Matrix pulled = m;
    for (std::size_t i = 0; i < 3; ++i) pulled[i][i] += kPull * tolerance * largest;
    x = least_in_box(pulled, right, low, high);
  }
  return mass + Vec3{x[0], x[1], x[2]};
}

// The counts of a block, beside its loops' vertices.
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

  void run(SurfaceReport& report) {
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

  // The crossing of an edge of the grid, in spacings from the block's first sample.
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

  void place_vertices(SurfaceReport& report) {
    const auto thickness = static_cast<float>(blocks_.field().thickness());
    PerThread<SurfaceCounts> counted;
    each_block([&](std::size_t, const Block& block, const CornerBits& corners, const Neighbourhood& values) {
      const auto beside = blocks_.beside(block, 1);
      for_each_cell(block, corners, values, points_.level(), [&](CellAt at, const CellCase& found, std::uint32_t) {
        const CellOf cell{&block, at.x, at.y, at.z};
        const SpecialCell* const special = found.loop_count > 1 ? cells_.special(cell) : nullptr;
        for (int loop = 0; loop < found.loop_count; ++loop) {
          Vec3& vertex = mesh_.vertices[cells_.vertex_of_loop(cell, special, loop)];
          // If several pieces pass through a cell, the means of their crossings keep them apart.
          vertex = points_.at(block.at, loop_point(beside, at, found.loop(loop), found.loop_count > 1));
          // Two loops have the same vertex: move this one from its mean towards a point of its own.
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
    const Vec3 lower = grid.position(8 * block.at[0] + x, 8 * block.at[1] + y, 8 * block.at[2] + z);
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

  // The middles of the two segments of a doubled face; the segment with the face's lowest edge comes first.
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
  std::vector<std::uint32_t> first_face_;  // by block: its first vertex on a face; its vertices on edges follow
  std::vector<ContourCounts> counts_;
  std::vector<Cut> cuts_;  // by edge
};

}  // namespace

void contour_dually(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory,
                    Mesh& mesh, SurfaceReport& report, ProgressMeter& progress) {
  DualContouring(blocks, points, source, memory, mesh, progress).run(report);
}

}  // namespace standoff
