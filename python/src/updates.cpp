// SPDX-License-Identifier: Apache-2.0
// Fields of meshes of which a part moved.
#include "standoff/update.h"

#include <memory>
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

// One call at a time: others wait for it, without the interpreter's lock.
class Live {
 public:
  Live(const VertexInput& vertices, const FaceInput& faces, const Grid& grid, double thickness,
       ComputeOptions options) {
    options.progress = calls_.callback();
    calls_.run(nb::none(), [&] {
      live_ = std::make_unique<LiveField>(view_of(vertices, faces), grid, thickness, options);
      sign_ = live_->report().sign;
    });
  }

  nb::dict move(const IndexInput& vertices, const PointInput& positions, const nb::object& progress) {
    UpdateReport done;
    double seconds = 0;
    calls_.run(progress, [&] {
      const Timed timed(seconds);
      done = live_->move({vertices.data(), vertices.size()}, points_of(positions));
      sign_ = done.sign;
    });
    return dict_of(done, seconds);
  }
  DistanceField field() {
    DistanceField copy;
    calls_.run(nb::none(), [&] { copy = live_->field(); });
    return copy;
  }
  Array<double> vertices() {
    std::vector<Vec3> copy;
    calls_.run(nb::none(), [&] { copy.assign(live_->mesh().vertices.begin(), live_->mesh().vertices.end()); });
    return array_over<double>(std::move(copy));
  }
  nb::dict sign() {
    SignReport copy;
    calls_.run(nb::none(), [&] { copy = sign_; });
    return sign_dict(copy);
  }

 private:
  CallsInTurn calls_;
  std::unique_ptr<LiveField> live_;
  SignReport sign_;  // of the mesh as it is now
};

}  // namespace

void add_updates(nb::module_& m) {
  m.def("update", &update, "field"_a, "vertices_before"_a.noconvert(), "faces_before"_a.noconvert(),
        "vertices"_a.noconvert(), "faces"_a.noconvert(), "changed"_a.none(), "sign"_a, "method"_a, "threads"_a,
        "device"_a, "memory_limit"_a, "progress"_a.none());
  nb::class_<Live>(m, "Live")
      .def(
          "__init__",
          [](Live* at, const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
             const nb::handle& sign, const std::string& method, bool nearest, int threads, const std::string& device,
             std::int64_t memory_limit) {
            new (at) Live(vertices, faces, grid.grid(), thickness,
                          compute_options(sign, method, nearest, threads, device, memory_limit));
          },
          "vertices"_a, "faces"_a, "grid"_a, "thickness"_a, "sign"_a.none(), "method"_a, "nearest"_a, "threads"_a,
          "device"_a, "memory_limit"_a)
      .def("move", &Live::move, "vertices"_a, "positions"_a, "progress"_a.none())
      .def("field", &Live::field)
      .def("vertices", &Live::vertices)
      .def_prop_ro("sign", &Live::sign);
}

}  // namespace standoff::python
