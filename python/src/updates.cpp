// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moved.
#include "standoff/update.h"

#include <algorithm>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "arrays.h"
#include "computed.h"
#include "options.h"
#include "work.h"

namespace standoff::python {
namespace {

using IndexInput = nb::ndarray<nb::ro, const std::uint32_t, nb::shape<-1>, nb::c_contig, nb::device::cpu>;

nb::dict dict_of(const UpdateReport& r, double seconds) {
  nb::dict d;
  d["anew"] = r.anew;
  d["why"] = r.why;
  d["triangles_changed"] = r.triangles_changed;
  d["windows"] = r.windows;
  d["tiles_computed"] = r.tiles_computed;
  d["tiles_changed"] = r.tiles_changed;
  d["seconds"] = seconds;
  d["sign"] = sign_dict(r.sign);
  return d;
}

// Updates a copy: what Python has of a field stays as it is.
nb::tuple update(const DistanceField& field, const VertexInput& vertices_before, const FaceInput& faces_before,
                 const VertexInput& vertices, const FaceInput& faces, const std::optional<IndexInput>& changed,
                 const nb::handle& sign, const std::string& method, int threads, const std::string& device,
                 std::int64_t memory_limit, const nb::object& progress) {
  const MeshView before = view_of(vertices_before, faces_before), after = view_of(vertices, faces);
  ComputeOptions options = compute_options(sign, method, field.has_nearest(), threads, device, memory_limit);
  double seconds = 0;
  DistanceField made;
  const UpdateReport done = watched(progress, [&](const ProgressCallback& report) {
    options.progress = report;
    const Timed timed(seconds);
    made = field;
    std::vector<std::uint32_t> found;
    if (!changed) found = changed_triangles(before, after);
    const std::span<const std::uint32_t> given =
        changed ? std::span(changed->data(), changed->size()) : std::span<const std::uint32_t>(found);
    return update_field(before, after, given, made, options);
  });
  return nb::make_tuple(std::move(made), dict_of(done, seconds));
}

}  // namespace

void add_updates(nb::module_& m) {
  m.def("update", &update, "field"_a, "vertices_before"_a.noconvert(), "faces_before"_a.noconvert(),
        "vertices"_a.noconvert(), "faces"_a.noconvert(), "changed"_a.none(), "sign"_a, "method"_a, "threads"_a,
        "device"_a, "memory_limit"_a, "progress"_a.none());
}

}  // namespace standoff::python
