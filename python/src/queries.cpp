// SPDX-License-Identifier: Apache-2.0
// Exact answers at points.
#include "arrays.h"
#include "lock.h"
#include "options.h"
#include "standoff/points.h"
#include "work.h"

namespace standoff::python {
namespace {

// Of fewer points the answers come at once, and a thread of their own would take longer.
constexpr std::size_t kFewPoints = 2000;

// Calls ask(progress): on this thread for few points that nobody watches, else watched.
template <class Ask>
void ask(const nb::object& progress, std::size_t points, const Ask& ask_points) {
  if (points > kFewPoints || !progress.is_none()) return run_watched(progress, ask_points);
  const Unlocked released;
  ask_points(ProgressCallback{});
}

MeshQuery build(const VertexInput& vertices, const FaceInput& faces, const nb::handle& sign, int threads) {
  const MeshView mesh = view_of(vertices, faces);
  MeshQueryOptions options{.sign = sign_of(sign), .execution = {.threads = threads}};
  return watched(nb::none(), [&](const ProgressCallback& report) {
    options.progress = report;
    return MeshQuery(mesh, options);
  });
}

Array<double> distances(const MeshQuery& query, const PointInput& points, int threads, const std::string& device,
                        const nb::object& progress) {
  NewArray<double> out({points.shape(0)});
  const Execution execution = execution_of(threads, device);
  ask(progress, points.shape(0), [&](const ProgressCallback& report) {
    query.distances(points_of(points), {out.data(), out.count()}, {.execution = execution, .progress = report});
  });
  return out.finish();
}

Array<double> winding_numbers(const MeshQuery& query, const PointInput& points, int threads,
                              const nb::object& progress) {
  NewArray<double> out({points.shape(0)});
  ask(progress, points.shape(0), [&](const ProgressCallback& report) {
    query.winding_numbers(points_of(points), {out.data(), out.count()},
                          {.execution = {.threads = threads}, .progress = report});
  });
  return out.finish();
}

// distance, point, triangle, feature, barycentric, gradient
nb::tuple closest(const MeshQuery& query, const PointInput& points, int threads, const std::string& device,
                  const nb::object& progress) {
  const std::size_t count = points.shape(0);
  NewArray<double> distance({count}), point({count, 3}), barycentric({count, 3}), gradient({count, 3});
  NewArray<std::uint32_t> triangle({count});
  NewArray<std::uint8_t> feature({count});
  const Execution execution = execution_of(threads, device);
  const std::span<const Vec3> asked = points_of(points);
  // The answers of one part at a time, so that no second copy of all of them exists.
  constexpr std::size_t kPart = std::size_t{1} << 17;
  ask(progress, count, [&](const ProgressCallback& report) {
    std::vector<ClosestPoint> answers(std::min(count, kPart));
    for (std::size_t first = 0; first < count; first += kPart) {
      const std::size_t size = std::min(kPart, count - first);
      const auto share = [&](const Progress& p) {
        const double done = static_cast<double>(first) + p.fraction * static_cast<double>(size);
        return report({p.stage, done / static_cast<double>(count)});
      };
      const std::span<ClosestPoint> part(answers.data(), size);
      query.closest(asked.subspan(first, size), part,
                    {.execution = execution, .progress = report ? ProgressCallback(share) : ProgressCallback{}});
      for (std::size_t n = 0; n < size; ++n) {
        const ClosestPoint& from = answers[n];
        const std::size_t to = first + n;
        const Vec3 slope = query.gradient(asked[to], from);
        distance[to] = from.distance;
        triangle[to] = from.triangle;
        feature[to] = static_cast<std::uint8_t>(from.feature);
        const double p[3] = {from.point.x, from.point.y, from.point.z};
        const double g[3] = {slope.x, slope.y, slope.z};
        for (std::size_t k = 0; k < 3; ++k) {
          point[3 * to + k] = p[k];
          barycentric[3 * to + k] = from.barycentric[k];
          gradient[3 * to + k] = g[k];
        }
      }
    }
  });
  return nb::make_tuple(distance.finish(), point.finish(), triangle.finish(), feature.finish(), barycentric.finish(),
                        gradient.finish());
}

// The mesh that the query has a copy of; the arrays keep the query.
nb::tuple mesh_of(nb::handle_t<MeshQuery> self) {
  const MeshView mesh = nb::cast<const MeshQuery&>(self).mesh();
  const auto vertices = mesh.vertices.as_span();
  const auto triangles = mesh.triangles.as_span();
  const std::size_t vertex_shape[2] = {mesh.vertices.size(), 3}, triangle_shape[2] = {mesh.triangles.size(), 3};
  return nb::make_tuple(
      nb::ndarray<nb::numpy, nb::ro, const double>(vertices->data(), 2, vertex_shape, self),
      nb::ndarray<nb::numpy, nb::ro, const std::uint32_t>(triangles->data(), 2, triangle_shape, self));
}

}  // namespace

void add_queries(nb::module_& m) {
  nb::class_<MeshQuery>(m, "Query")
      .def_prop_ro("sign", [](const MeshQuery& q) { return sign_dict(q.sign()); })
      .def_prop_ro("memory_bytes", &MeshQuery::memory_bytes)
      .def("mesh", &mesh_of)
      .def("distances", &distances, "points"_a.noconvert(), "threads"_a, "device"_a, "progress"_a.none())
      .def("closest", &closest, "points"_a.noconvert(), "threads"_a, "device"_a, "progress"_a.none())
      .def("winding_numbers", &winding_numbers, "points"_a.noconvert(), "threads"_a, "progress"_a.none())
      .def(
          "save",
          [](const MeshQuery& query, const std::filesystem::path& path, bool overwrite) {
            const Unlocked released;
            query.save(path, overwrite ? Existing::replace : Existing::keep);
          },
          "path"_a, "overwrite"_a);
  m.def("build_query", &build, "vertices"_a.noconvert(), "faces"_a.noconvert(), "sign"_a, "threads"_a);
  m.def("read_query", &MeshQuery::load, "path"_a, nb::call_guard<Unlocked>());
}

}  // namespace standoff::python
