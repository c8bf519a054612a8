// SPDX-License-Identifier: Apache-2.0
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "core/guarded.h"
#include "core/mesh_copy.h"
#include "core/number_text.h"
#include "core/threads.h"
#include "field/skip.h"
#include "geometry/triangle_frame.h"
#include "points/device.h"
#include "points/nearest.h"
#include "points/query_data.h"
#include "sign/open_winding/cap_tree.h"
#include "sign/outer/outer.h"
#include "sign/plan.h"
#include "simd/dispatch.h"
#include "standoff/error.h"
#include "standoff/sign.h"

namespace standoff {
namespace {

void check(MeshView mesh, const MeshQueryOptions& options) {
  validate("points", options.execution, Runs::on_the_cpu);
  validate(options.sign);
  if (!find_info(options.sign.method)->at_points)
    throw Error(ErrorCode::usage, std::string("points: the sign method ") + name_of(options.sign.method) +
                                      " needs a grid; compute a field, or take another sign method");
  validate(mesh);
  const Box box = bounds(mesh);
  if (!(std::max(max_norm(box.min), max_norm(box.max)) <= kMaxCoordinate))
    throw Error(ErrorCode::limit, "points: the mesh reaches beyond " + number_text(kMaxCoordinate) + "; scale it down");
}

void check(std::span<const Vec3> points, std::size_t answers) {
  if (points.size() != answers)
    throw Error(ErrorCode::usage, "points: there is memory for " + std::to_string(answers) +
                                      " answers, but there are " + std::to_string(points.size()) +
                                      " points; they must be as many");
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (!is_finite(points[n]))
      throw Error(ErrorCode::usage, "points: point " + std::to_string(n) + " is not finite; leave it out");
    if (!(max_norm(points[n]) <= kMaxCoordinate))
      throw Error(ErrorCode::limit, "points: point " + std::to_string(n) + " lies beyond " +
                                        number_text(kMaxCoordinate) + "; scale it down");
  }
}

SignPlan plan_of(MeshView mesh, const SignOptions& options, ProgressMeter& progress) {
  SignPlan plan = plan_sign(mesh, options, progress);
  if (options.outer) plan_outer(mesh, options, plan, progress);
  if (find_info(plan.report.method)->at_points) return plan;
  plan.report.method = SignMethod::none;  // found by the diagnosis
  plan.report.sure = false;
  plan.report.why += "; that needs the grid of a field, so distances at points have no sign";
  expect_sure(plan, options);
  return plan;
}

// Up to this number of rays, other threads would join in too late to help.
constexpr std::size_t kFewRays = 32;

// Points whose signs one thread decides together.
struct Decided {
  std::span<const std::uint32_t> order;  ///< the index of each in the caller's points
  std::array<PointToSign, kTogether> to_sign;
  std::array<double, kTogether> distance;  ///< with its sign
};

void decide(const MeshQuery::Data& data, const cpu::PointKernels& kernels, const FoundTriangles& found,
            std::size_t begin, std::size_t end, WorkCheck& check, Decided& decided) {
  const std::size_t count = end - begin;
  decided.order = std::span(found.order).subspan(begin, count);
  for (std::size_t n = 0; n < count; ++n) {
    const NearestTriangle& nearest = found.nearest[begin + n];
    decided.to_sign[n] = {found.points[begin + n], nearest.distance, nearest.triangle};
    decided.distance[n] = nearest.distance;
  }
  if (data.plan.report.method == SignMethod::shell)
    for (double& distance : std::span(decided.distance).first(count)) {
      distance -= data.sign.shell / 2;
      if (data.sign.invert) distance = 0 - distance;
    }
  if (!data.signs || !data.plan.has_sign()) return;
  std::array<bool, kTogether> inside;
  data.signs->decide(std::span(decided.to_sign).first(count), kernels, check, std::span(inside).first(count));
  for (std::size_t n = 0; n < count; ++n)
    if (inside[n] != data.sign.invert && decided.distance[n] != 0) decided.distance[n] = -decided.distance[n];
}

// Calls answer(decided, first) for some points at a time, from many threads: decided.order[n] + first is the index of a
// point in `points`.
template <class Answer>
void answer_all(const MeshQuery::Data& data, std::span<const Vec3> points, const PointOptions& options,
                const Answer& answer) {
  const Execution& execution = options.execution;
  ProgressMeter progress(options.progress);
  progress.stage("points", static_cast<std::int64_t>(points.size()), 0, 1);
  const cpu::PointKernels& kernels = dispatch_of<cpu::PointKernels>().of(execution.simd, "points");
  const TriangleIndex& index = data.near();
  const PointDevice* const device = find_point_device(execution.backend, points.size());
  const auto answer_some = [&](const FoundTriangles& found, std::size_t first, std::size_t begin, std::size_t end,
                               WorkCheck& check) {
    const KeptByThread<Decided> decided;  // making one takes longer than answering a point
    decide(data, kernels, found, begin, end, check, *decided);
    answer(*decided, first);
  };
  if (!device && points.size() <= kTogether) {
    // The calling thread answers alone, in memory that it keeps: waking other threads costs more than it saves.
    const KeptByThread<FoundTriangles> found;
    find_nearest(index, kernels, points, *found, progress);
    WorkCheck check(progress, kLooks);
    return answer_some(*found, 0, 0, points.size(), check);
  }
  Threads(execution.threads).run([&] {
    FoundTriangles found;
    for (std::size_t first = 0; first < points.size(); first += kMostPointsAtOnce) {
      const std::span<const Vec3> part = points.subspan(first, std::min(kMostPointsAtOnce, points.size() - first));
      if (device)
        find_nearest_on_device(*device, execution.device, data.device_tree(), index, kernels, part, found, progress);
      else
        find_nearest(index, kernels, part, found, progress);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, part.size(), kTogether), [&](const auto& range) {
        WorkCheck check(progress, kLooks);
        for (std::size_t begin = range.begin(); begin < range.end(); begin += kTogether)
          answer_some(found, first, begin, std::min(range.end(), begin + kTogether), check);
      });
    }
  });
}

// Finds the closest points on the nearest triangles, with their features and weights.
void find_closest(const TriangleIndex& index, const cpu::PointKernels& kernels, const Decided& decided,
                  std::span<ClosestPoint> out) {
  constexpr std::size_t kCount = cpu::ClosestOfEight::kCount;
  cpu::ClosestOfEight eight;
  const cpu::BvhView& tree = index.tree();
  for (std::size_t begin = 0; begin < decided.order.size(); begin += kCount) {
    const std::size_t count = std::min(kCount, decided.order.size() - begin);
    double scale[kCount];
    for (std::size_t n = 0; n < kCount; ++n) {
      const PointToSign& one = decided.to_sign[begin + std::min(n, count - 1)];
      scale[n] = index.scale_at(one.at);
      const std::uint32_t* const corners = tree.corners + std::size_t{3} * one.triangle;
      for (int k = 0; k < 3; ++k) {
        const double* const at = tree.vertices + std::size_t{3} * corners[k];
        const Vec3 corner = (Vec3{at[0], at[1], at[2]} - one.at) * scale[n];
        eight.corners[k][0][n] = corner.x, eight.corners[k][1][n] = corner.y, eight.corners[k][2][n] = corner.z;
      }
    }
    kernels.closest(eight);
    for (std::size_t n = 0; n < count; ++n) {
      const PointToSign& one = decided.to_sign[begin + n];
      ClosestPoint& at = out[decided.order[begin + n]];
      at.distance = decided.distance[begin + n];
      at.point = Vec3{eight.point[0][n], eight.point[1][n], eight.point[2][n]} * (1 / scale[n]) + one.at;
      at.triangle = one.triangle;
      at.feature = static_cast<Feature>(static_cast<int>(eight.feature[n]));
      at.barycentric = {eight.weights[0][n], eight.weights[1][n], eight.weights[2][n]};
    }
  }
}

}  // namespace

MeshQuery::Data::Data(Mesh own, const SignOptions& options, SignPlan planned, int threads, Simd simd,
                      const ProgressCallback& while_built)
    : mesh(std::move(own)), sign(options), plan(std::move(planned)) {
  all.emplace(mesh, std::span<const std::uint32_t>{}, threads, simd, while_built);
  ProgressMeter progress(while_built);
  distinct = without_many_copies(mesh, plan.exposed, progress);
  if (const auto& some = distinct.empty() ? plan.exposed : distinct; !some.empty())
    counting.emplace(mesh, some, threads, simd, while_built);
  signs = make_point_signs({mesh, plan.use}, *all, plan, sign.rule, threads, simd);
}

const DeviceTree& MeshQuery::Data::device_tree() const {
  const std::lock_guard lock(tree_mutex_);
  // Isolation keeps this thread from taking up work that waits for the lock.
  if (!tree_) tbb::this_task_arena::isolate([&] { tree_ = std::make_unique<const DeviceTree>(near()); });
  return *tree_;
}

MeshQuery::MeshQuery(MeshView mesh, const MeshQueryOptions& options) try {
  check(mesh, options);
  Threads threads(options.execution.threads);
  ProgressMeter progress(options.progress);
  threads.run([&] {
    progress.stage("sign", 1, 0, 0.5);
    SignPlan plan = plan_of(mesh, options.sign, progress);
    progress.stage("search tree", 1, 0.5, 1);
    data_ = std::make_shared<const Data>(copy_of(mesh), options.sign, std::move(plan), threads.count(),
                                         options.execution.simd, [&progress](const Progress&) {
                                           progress.check();
                                           return true;
                                         });
  });
  progress.stage("done", 1, 1, 1);
} catch (...) {
  throw_as_error("points");
}

MeshView MeshQuery::mesh() const { return data_->mesh; }
const SignReport& MeshQuery::sign() const { return data_->plan.report; }

std::int64_t MeshQuery::memory_bytes() const {
  const Data& data = *data_;
  return static_cast<std::int64_t>(data.mesh.vertices.capacity() * sizeof(Vec3) +
                                   data.mesh.triangles.capacity() * sizeof(Triangle) + data.plan.use.capacity() +
                                   data.plan.boundary.edges.capacity() * sizeof(BoundaryEdge) +
                                   data.distinct.capacity() * sizeof(std::uint32_t)) +
         data.all->memory_bytes() + (data.counting ? data.counting->memory_bytes() : 0) +
         (data.signs ? data.signs->memory_bytes() : 0);
}

void MeshQuery::distances(std::span<const Vec3> points, std::span<double> out, const PointOptions& options) const try {
  validate("points", options.execution, Runs::everywhere);
  check(points, out.size());
  answer_all(*data_, points, options, [&](const Decided& decided, std::size_t first) {
    for (std::size_t n = 0; n < decided.order.size(); ++n) out[first + decided.order[n]] = decided.distance[n];
  });
} catch (...) {
  throw_as_error("points", "ask about fewer points at once, or provide more memory");
}

void MeshQuery::closest(std::span<const Vec3> points, std::span<ClosestPoint> out, const PointOptions& options) const
    try {
  validate("points", options.execution, Runs::everywhere);
  check(points, out.size());
  const cpu::PointKernels& kernels = dispatch_of<cpu::PointKernels>().of(options.execution.simd, "points");
  answer_all(*data_, points, options, [&](const Decided& decided, std::size_t first) {
    find_closest(data_->near(), kernels, decided, out.subspan(first));
  });
} catch (...) {
  throw_as_error("points", "ask about fewer points at once, or provide more memory");
}

void MeshQuery::winding_numbers(std::span<const Vec3> points, std::span<double> out, const PointOptions& options) const
    try {
  validate("points", options.execution, Runs::on_the_cpu);
  check(points, out.size());
  if (data_->plan.report.method != SignMethod::winding)
    throw Error(ErrorCode::usage,
                "points: winding numbers are known to queries whose sign method is winding; choose it");
  ProgressMeter progress(options.progress);
  progress.stage("points", static_cast<std::int64_t>(points.size()), 0, 1);
  const cpu::PointKernels& kernels = dispatch_of<cpu::PointKernels>().of(options.execution.simd, "points");
  const auto answer = [&](std::size_t n) {
    WorkCheck check(progress, kLooks);
    out[n] = data_->signs->winding_number(points[n], kernels, check);
    progress.advance();
  };
  if (points.size() <= (data_->signs->is_slow() ? 1 : kFewRays)) {
    for (std::size_t n = 0; n < points.size(); ++n) answer(n);
    return;
  }
  Threads(options.execution.threads).run([&] { tbb::parallel_for(std::size_t{0}, points.size(), answer); });
} catch (...) {
  throw_as_error("points", "ask about fewer points at once, or provide more memory");
}

Vec3 MeshQuery::gradient(Vec3 point, const ClosestPoint& at) const try {
  const MeshView mesh = data_->mesh;
  if (at.triangle >= mesh.triangles.size())
    throw Error(ErrorCode::usage,
                "points: the mesh has no triangle " + std::to_string(at.triangle) + "; take an answer of this query");
  const double scale = data_->near().scale_at(point);
  const Vec3 away = (point - at.point) * scale;
  const double distance = length(away);
  const auto corner = [&](int k) { return triple_of((mesh.corner(at.triangle, k) - point) * scale); };
  // Bound the rounding error of the vector to the surface: below it, the vector has no direction.
  double extent = max_norm(point) * scale;
  for (int k = 0; k < 3; ++k) extent = std::max(extent, max_norm(vec_of(corner(k))));
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  if (distance > kRounding * extent) {
    // The distance of a shell grows away from the mesh, on both sides of its own surface.
    const bool shell = data_->plan.report.method == SignMethod::shell;
    return away * ((shell ? data_->sign.invert : at.distance < 0) ? -1 / distance : 1 / distance);
  }
  const TriangleFrame<double> frame = make_frame(corner(0), corner(1), corner(2), kLeastLengthSqOfCells);
  const Vec3 normal = vec_of(frame.z.g);
  // A frame may swap the corners, so its z axis may be either normal.
  const Vec3 facing = vec_of(cross(corner(1) - corner(0), corner(2) - corner(0)));
  const int use = OrientedMesh{mesh, data_->plan.use}.use_of(at.triangle);
  const bool is_reversed = (dot(normal, facing) < 0) != (use < 0);
  return is_reversed != data_->sign.invert ? normal * -1.0 : normal;
} catch (...) {
  throw_as_error("points");
}

std::vector<ClosestPoint> closest_points(MeshView mesh, std::span<const Vec3> points, const PointOptions& options) try {
  std::vector<ClosestPoint> found(points.size());
  MeshQuery(mesh, {.sign = {SignMethod::none}, .execution = options.execution}).closest(points, found, options);
  return found;
} catch (...) {
  throw_as_error("points", "ask about fewer points at once, or provide more memory");
}

}  // namespace standoff
