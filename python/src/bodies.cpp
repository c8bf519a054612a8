// SPDX-License-Identifier: Apache-2.0
// Queries between two bodies: results as arrays, one row for each pose.
#include "arrays.h"
#include "lock.h"
#include "options.h"
#include "standoff/collision.h"
#include "work.h"

namespace standoff::python {
namespace {

// The first part of a batch, of which the others follow from the time it takes. A GPU gets all at once.
std::size_t first_part(const Execution& execution, std::size_t count) {
  return execution.backend == Backend::cpu || execution.backend == Backend::automatic ? 64 : count;
}

void put(NewArray<double>& array, std::size_t row, Vec3 v) {
  array[3 * row] = v.x;
  array[3 * row + 1] = v.y;
  array[3 * row + 2] = v.z;
}

Body build(const VertexInput& vertices, const FaceInput& faces, double spacing, int threads,
           const std::string& device) {
  const MeshView mesh = view_of(vertices, faces);
  BodyOptions options{.spacing = spacing, .execution = execution_of(threads, device)};
  return watched(nb::none(), [&](const ProgressCallback& report) {
    options.progress = report;
    return Body(mesh, options);
  });
}

// verdict (0 free, 1 hit, 2 ambiguous), triangle_a, triangle_b, containment
nb::tuple collide_poses(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& poses, double margin,
                        bool containment, bool certified, int threads, const std::string& device,
                        const nb::object& progress) {
  const std::size_t count = poses.shape(0);
  NewArray<std::uint8_t> verdict({count}), inside({count});
  NewArray<std::uint32_t> triangle_a({count}), triangle_b({count});
  const CollideOptions options{
      .margin = margin, .mode = certified ? CollideMode::certified : CollideMode::exact, .containment = containment};
  const Execution execution = execution_of(threads, device);
  const Pose at = pose_of(pose_a, 0);
  const std::vector<Pose> all = poses_of(poses);
  run_in_parts(progress, count, first_part(execution, count), [&](std::size_t first, std::size_t last) {
    const auto results = collide_all(a, at, b, std::span(all).subspan(first, last - first), options, execution).results;
    for (std::size_t n = first; n < last; ++n) {
      const CollisionResult& r = results[n - first];
      verdict[n] = static_cast<std::uint8_t>(r.verdict);
      triangle_a[n] = r.triangle_a;
      triangle_b[n] = r.triangle_b;
      inside[n] = static_cast<std::uint8_t>(r.containment);
    }
  });
  return nb::make_tuple(verdict.finish(), triangle_a.finish(), triangle_b.finish(), inside.finish());
}

// lower, upper, point_a, point_b, triangle_a, triangle_b, finished
nb::tuple distance_poses(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& poses,
                         double tolerance, double limit, std::int64_t max_steps, int threads, const std::string& device,
                         const nb::object& progress) {
  const std::size_t count = poses.shape(0);
  NewArray<std::uint8_t> finished({count});
  NewArray<double> lower({count}), upper({count}), point_a({count, 3}), point_b({count, 3});
  NewArray<std::uint32_t> triangle_a({count}), triangle_b({count});
  const DistanceOptions options{.tolerance = tolerance, .limit = limit, .max_steps = max_steps};
  const Execution execution = execution_of(threads, device);
  const Pose at = pose_of(pose_a, 0);
  const std::vector<Pose> all = poses_of(poses);
  run_in_parts(progress, count, first_part(execution, count), [&](std::size_t first, std::size_t last) {
    const auto results =
        distance_all(a, at, b, std::span(all).subspan(first, last - first), options, execution).results;
    for (std::size_t n = first; n < last; ++n) {
      const DistanceResult& r = results[n - first];
      lower[n] = r.lower;
      upper[n] = r.upper;
      put(point_a, n, r.point_a);
      put(point_b, n, r.point_b);
      triangle_a[n] = r.triangle_a;
      triangle_b[n] = r.triangle_b;
      finished[n] = r.finished ? 1 : 0;
    }
  });
  return nb::make_tuple(lower.finish(), upper.finish(), point_a.finish(), point_b.finish(), triangle_a.finish(),
                        triangle_b.finish(), finished.finish());
}

// The arrays of the answers of sweeps.
struct SweepArrays {
  NewArray<std::uint8_t> hit, finished;
  NewArray<double> time, point, normal;
  NewArray<std::uint32_t> triangle_a, triangle_b;

  explicit SweepArrays(std::size_t count)
      : hit({count}),
        finished({count}),
        time({count}),
        point({count, 3}),
        normal({count, 3}),
        triangle_a({count}),
        triangle_b({count}) {}

  void set(std::size_t n, const SweepResult& r) {
    hit[n] = r.hit ? 1 : 0;
    finished[n] = r.finished ? 1 : 0;
    time[n] = r.time;
    put(point, n, r.point);
    put(normal, n, r.normal);
    triangle_a[n] = r.triangle_a;
    triangle_b[n] = r.triangle_b;
  }
  // hit, time, point, normal, triangle_a, triangle_b, finished
  nb::tuple finish() {
    return nb::make_tuple(hit.finish(), time.finish(), point.finish(), normal.finish(), triangle_a.finish(),
                          triangle_b.finish(), finished.finish());
  }
};

Vec3 vec_of(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

nb::tuple sweep_motions(const Body& a, const PoseInput& pose_a, const Body& b, std::span<const RigidMotion> motions,
                        const SweepOptions& options, const Execution& execution, const nb::object& progress) {
  const std::size_t count = motions.size();
  SweepArrays arrays(count);
  const Pose at = pose_of(pose_a, 0);
  run_in_parts(progress, count, first_part(execution, count), [&](std::size_t first, std::size_t last) {
    const auto results = sweep_all(a, at, b, motions.subspan(first, last - first), options, execution).results;
    for (std::size_t n = first; n < last; ++n) arrays.set(n, results[n - first]);
  });
  return arrays.finish();
}

nb::tuple sweep_poses(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& from, const PoseInput& to,
                      std::array<double, 3> center, double tolerance, std::int64_t max_steps, int threads,
                      const std::string& device, const nb::object& progress) {
  const std::vector<Pose> first_poses = poses_of(from), last_poses = poses_of(to);
  std::vector<RigidMotion> motions(first_poses.size());
  for (std::size_t n = 0; n < motions.size(); ++n) motions[n] = {first_poses[n], last_poses[n], vec_of(center)};
  return sweep_motions(a, pose_a, b, motions, {.tolerance = tolerance, .max_steps = max_steps},
                       execution_of(threads, device), progress);
}

nb::tuple sweep_screws(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& starts,
                       std::array<double, 3> point, std::array<double, 3> axis, double angle_rad, double along,
                       double tolerance, std::int64_t max_steps, int threads, const std::string& device,
                       const nb::object& progress) {
  std::vector<RigidMotion> motions;
  for (const Pose& start : poses_of(starts))
    motions.push_back(screw_motion(start, vec_of(point), vec_of(axis), angle_rad, along));
  return sweep_motions(a, pose_a, b, motions, {.tolerance = tolerance, .max_steps = max_steps},
                       execution_of(threads, device), progress);
}

// The motion of the path, and the arrays of one sweep.
nb::tuple sweep_along(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& poses,
                      std::array<double, 3> center, double tolerance, std::int64_t max_steps) {
  const Pose at = pose_of(pose_a, 0);
  const std::vector<Pose> all = poses_of(poses);
  std::vector<RigidMotion> path;
  for (std::size_t n = 1; n < all.size(); ++n) path.push_back({all[n - 1], all[n], vec_of(center)});
  const PathSweepResult found = watched(nb::none(), [&](const ProgressCallback&) {
    return sweep_path(a, at, b, path, {.tolerance = tolerance, .max_steps = max_steps});
  });
  SweepArrays arrays(1);
  arrays.set(0, found.sweep);
  return nb::make_tuple(found.motion, arrays.finish());
}

// point, normal, depth, triangle_a, triangle_b, overflow
nb::tuple contacts_of(const Body& a, const PoseInput& pose_a, const Body& b, const PoseInput& pose_b, std::int64_t most,
                      double margin) {
  const Pose at = pose_of(pose_a, 0), b_at = pose_of(pose_b, 0);
  const ContactResult result = watched(
      nb::none(), [&](const ProgressCallback&) { return contacts(a, at, b, b_at, {.most = most, .margin = margin}); });
  const std::size_t count = result.contacts.size();
  NewArray<double> point({count, 3}), normal({count, 3}), depth({count});
  NewArray<std::uint32_t> triangle_a({count}), triangle_b({count});
  for (std::size_t n = 0; n < count; ++n) {
    const ContactPoint& c = result.contacts[n];
    put(point, n, c.point);
    put(normal, n, c.normal);
    depth[n] = c.depth;
    triangle_a[n] = c.triangle_a;
    triangle_b[n] = c.triangle_b;
  }
  return nb::make_tuple(point.finish(), normal.finish(), depth.finish(), triangle_a.finish(), triangle_b.finish(),
                        result.overflow);
}

}  // namespace

void add_bodies(nb::module_& m) {
  nb::class_<Body>(m, "Body")
      .def_prop_ro("has_inside", &Body::has_inside)
      .def_prop_ro("thickness", &Body::thickness)
      .def_prop_ro("memory_bytes", &Body::memory_bytes)
      .def_prop_ro("triangles", [](const Body& b) { return b.mesh().triangles.size(); })
      .def_prop_ro(
          "bounds",
          [](const Body& b) {
            const Box box = b.bounds();
            return std::array{std::array{box.min.x, box.min.y, box.min.z}, std::array{box.max.x, box.max.y, box.max.z}};
          })
      .def(
          "save",
          [](const Body& body, const std::filesystem::path& path, bool overwrite) {
            const Unlocked released;
            body.save(path, overwrite ? Existing::replace : Existing::keep);
          },
          "path"_a, "overwrite"_a);
  m.def("build_body", &build, "vertices"_a.noconvert(), "faces"_a.noconvert(), "spacing"_a, "threads"_a, "device"_a);
  m.def("read_body", &Body::load, "path"_a, nb::call_guard<Unlocked>());
  m.def("automatic_tolerance", &automatic_tolerance, "a"_a, "b"_a);
  m.def("collide", &collide_poses, "a"_a, "pose_a"_a.noconvert(), "b"_a, "poses"_a.noconvert(), "margin"_a,
        "containment"_a, "certified"_a, "threads"_a, "device"_a, "progress"_a.none());
  m.def("distance", &distance_poses, "a"_a, "pose_a"_a.noconvert(), "b"_a, "poses"_a.noconvert(), "tolerance"_a,
        "limit"_a, "max_steps"_a, "threads"_a, "device"_a, "progress"_a.none());
  m.def("sweep", &sweep_poses, "a"_a, "pose_a"_a.noconvert(), "b"_a, "start"_a.noconvert(), "end"_a.noconvert(),
        "center"_a, "tolerance"_a, "max_steps"_a, "threads"_a, "device"_a, "progress"_a.none());
  m.def("sweep_screw", &sweep_screws, "a"_a, "pose_a"_a.noconvert(), "b"_a, "start"_a.noconvert(), "point"_a, "axis"_a,
        "angle_rad"_a, "along"_a, "tolerance"_a, "max_steps"_a, "threads"_a, "device"_a, "progress"_a.none());
  m.def("sweep_path", &sweep_along, "a"_a, "pose_a"_a.noconvert(), "b"_a, "poses"_a.noconvert(), "center"_a,
        "tolerance"_a, "max_steps"_a);
  m.def("contacts", &contacts_of, "a"_a, "pose_a"_a.noconvert(), "b"_a, "pose_b"_a.noconvert(), "most"_a, "margin"_a);
}

}  // namespace standoff::python
