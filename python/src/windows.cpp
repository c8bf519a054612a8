// SPDX-License-Identifier: Apache-2.0
// Fields in windows.
#include "standoff/windows.h"

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "computed.h"
#include "options.h"
#include "work.h"

namespace standoff::python {
namespace {

// One call at a time: others wait for it, without the interpreter's lock.
class Windows {
 public:
  // The arrays must stay where they are: this keeps them.
  Windows(VertexInput vertices, FaceInput faces, const Grid& grid, double thickness, const Size3& largest,
          ComputeOptions options)
      : vertices_(std::move(vertices)), faces_(std::move(faces)) {
    options.progress = calls_.callback();
    calls_.run(nb::none(), [&] {
      windows_ = std::make_unique<WindowComputation>(view_of(vertices_, faces_), grid, thickness, largest, options);
    });
  }

  nb::tuple field(const Counts& first, const Counts& size, const nb::object& progress) {
    DistanceField made;
    ComputeReport done;
    double seconds = 0;
    calls_.run(progress, [&] {
      const Timed timed(seconds);
      windows_->compute(size_of(first), size_of(size), made);
      done = windows_->report();
    });
    return nb::make_tuple(std::move(made), computation_dict(done, seconds));
  }

  bool is_reached(const Counts& first, const Counts& size) {
    bool reached = false;
    calls_.run(nb::none(), [&] { reached = windows_->is_reached(size_of(first), size_of(size)); });
    return reached;
  }
  bool is_empty(const Counts& first, const Counts& size) {
    bool empty = false;
    calls_.run(nb::none(), [&] { empty = windows_->is_empty(size_of(first), size_of(size)); });
    return empty;
  }
  bool is_whole() const { return windows_->is_whole(); }
  nb::bytes decision() {
    std::vector<std::byte> bytes;
    calls_.run(nb::none(), [&] { bytes = windows_->decision().bytes(); });
    return nb::bytes(bytes.data(), bytes.size());
  }
  nb::dict sign() const { return sign_dict(windows_->report().sign); }
  const Provenance& provenance() const { return windows_->report().provenance; }

 private:
  VertexInput vertices_;
  FaceInput faces_;
  CallsInTurn calls_;
  std::unique_ptr<WindowComputation> windows_;
};

}  // namespace

void add_windows(nb::module_& m) {
  nb::class_<Windows>(m, "Windows")
      .def(
          "__init__",
          [](Windows* at, const VertexInput& vertices, const FaceInput& faces, const GridInput& grid, double thickness,
             const Counts& largest, const nb::handle& sign, const std::string& method, bool nearest, int threads,
             const std::string& device, std::int64_t memory_limit, const std::optional<nb::bytes>& decision) {
            ComputeOptions options = compute_options(sign, method, nearest, threads, device, memory_limit);
            if (decision)
              options.decision =
                  SignDecision::from_bytes({static_cast<const std::byte*>(decision->data()), decision->size()});
            new (at) Windows(vertices, faces, grid.grid(), thickness, size_of(largest), std::move(options));
          },
          "vertices"_a, "faces"_a, "grid"_a, "thickness"_a, "largest"_a, "sign"_a.none(), "method"_a, "nearest"_a,
          "threads"_a, "device"_a, "memory_limit"_a, "decision"_a.none())
      .def("field", &Windows::field, "first"_a, "shape"_a, "progress"_a.none())
      .def("is_empty", &Windows::is_empty, "first"_a, "shape"_a)
      .def("is_reached", &Windows::is_reached, "first"_a, "shape"_a)
      .def_prop_ro("is_whole", &Windows::is_whole)
      .def_prop_ro("decision", &Windows::decision)
      .def_prop_ro("sign", &Windows::sign)
      .def_prop_ro("provenance", &Windows::provenance);
}

}  // namespace standoff::python
