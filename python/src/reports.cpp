// SPDX-License-Identifier: Apache-2.0
// What is known of a mesh, and the check of a field against its mesh.
#include "arrays.h"
#include "options.h"
#include "standoff/mesh_report.h"
#include "standoff/verify.h"
#include "work.h"

namespace standoff::python {
namespace {

std::array<double, 3> numbers(Vec3 v) { return {v.x, v.y, v.z}; }

nb::dict dict_of(const MeshComponent& c) {
  nb::dict d;
  d["triangles"] = c.triangles;
  d["first_triangle"] = c.first_triangle;
  d["bounds"] = std::array{numbers(c.bounds.min), numbers(c.bounds.max)};
  d["area"] = c.area;
  d["volume"] = c.volume;
  d["centroid"] = numbers(c.centroid);
  d["inertia"] = c.inertia;
  d["closed"] = c.closed;
  d["solid"] = c.solid;
  d["depth"] = c.depth;
  return d;
}

nb::dict dict_of(const MeshReport& r) {
  nb::dict d;
  d["triangles"] = r.triangles;
  d["positions"] = r.positions;
  d["bounds"] = std::array{numbers(r.bounds.min), numbers(r.bounds.max)};
  d["area"] = r.area;
  d["volume"] = r.volume;
  d["closed"] = r.closed();
  d["degenerate"] = r.degenerate;
  d["duplicate"] = r.duplicate;
  d["duplicate_same"] = r.duplicate_same;
  d["duplicate_opposite"] = r.duplicate_opposite;
  d["two_sided"] = r.two_sided;
  d["open_edges"] = r.open_edges;
  d["nonmanifold_edges"] = r.nonmanifold_edges;
  d["inconsistent_edges"] = r.inconsistent_edges;
  d["flipped"] = r.flipped;
  d["left_out"] = r.left_out;
  d["cancelled_parts"] = r.cancelled_parts;
  d["cancelled_share"] = r.cancelled_share;
  d["inconsistent_after"] = r.inconsistent_after;
  d["unorientable"] = r.unorientable;
  d["patches"] = r.patches;
  d["boundary_edges"] = r.boundary_edges;
  d["boundary_loops"] = r.boundary_loops;
  d["boundary_length"] = r.boundary_length;
  d["largest_hole"] = r.largest_hole;
  d["largest_hole_in_samples"] = r.largest_hole_in_samples;
  d["cap_share"] = r.cap_share;
  d["openness"] = r.openness;
  d["component_count"] = r.component_count;
  nb::list components;
  for (const MeshComponent& c : r.components) components.append(dict_of(c));
  d["components"] = components;
  d["deepest"] = r.deepest;
  d["nesting_known"] = r.nesting_known;
  d["least_winding"] = r.least_winding;
  d["most_winding"] = r.most_winding;
  d["intersecting_pairs"] = r.intersecting_pairs;
  d["intersections_known"] = r.intersections_known;
  d["sign"] = r.method == SignMethod::none ? "none" : name_of(r.method);
  d["sure"] = r.sure;
  d["why"] = r.why;
  return d;
}

nb::dict report_of(const VertexInput& vertices, const FaceInput& faces, double spacing, std::int64_t most_components,
                   std::int64_t most_intersections, int threads) {
  const MeshView mesh = view_of(vertices, faces);
  MeshReportOptions options{.spacing = spacing,
                            .most_components = most_components,
                            .most_intersections = most_intersections,
                            .execution = {.threads = threads}};
  return dict_of(watched(nb::none(), [&](const ProgressCallback& progress) {
    options.progress = progress;
    return report(mesh, options);
  }));
}

nb::dict verify_field(const DistanceField& field, const VertexInput& vertices, const FaceInput& faces,
                      std::int64_t samples, std::uint64_t seed, int threads, const nb::object& progress) {
  const MeshView mesh = view_of(vertices, faces);
  const VerifyResult r = watched(progress, [&](const ProgressCallback& report) {
    return verify(field, mesh,
                  {.samples = samples, .seed = seed, .execution = {.threads = threads}, .progress = report});
  });
  nb::dict d;
  d["ok"] = r.ok();
  d["samples"] = r.samples;
  d["samples_band"] = r.samples_band;
  d["samples_wrong"] = r.samples_wrong;
  d["nearest_wrong"] = r.nearest_wrong;
  d["largest_error"] = r.largest.error;
  d["allowed_error"] = r.largest.allowed;
  d["sign_checked"] = r.sign.checked;
  d["sign_wrong"] = r.sign.wrong;
  d["sign_unknown"] = r.sign.unknown;
  d["mesh_differs"] = r.mesh_differs;
  return d;
}

}  // namespace

void add_reports(nb::module_& m) {
  m.def("report", &report_of, "vertices"_a.noconvert(), "faces"_a.noconvert(), "spacing"_a, "most_components"_a,
        "most_intersections"_a, "threads"_a);
  m.def("verify", &verify_field, "field"_a, "vertices"_a.noconvert(), "faces"_a.noconvert(), "samples"_a, "seed"_a,
        "threads"_a, "progress"_a.none());
}

}  // namespace standoff::python
