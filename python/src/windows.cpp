// SPDX-License-Identifier: Apache-2.0
// Fields in windows.
#include "standoff/windows.h"

#include <mutex>
#include <utility>

#include "arrays.h"
#include "computed.h"
#include "options.h"
#include "work.h"

namespace standoff::python {
namespace {

Size3 size_of(const std::array<std::int64_t, 3>& counts) { return {counts[0], counts[1], counts[2]}; }

// One call at a time: others wait for it, without the interpreter's lock.
class Windows {
 public:
  // The arrays must stay where they are: this keeps them.
  Windows(VertexInput vertices, FaceInput faces) : vertices_(std::move(vertices)), faces_(std::move(faces)) {}

  void prepare(const Grid& grid, double thickness, const Size3& largest, ComputeOptions options) {
    watched_call(nb::none(), [&](const ProgressCallback&) {
      options.progress = [this](const Progress& now) { return !report_ || report_(now); };
      windows_ = std::make_unique<WindowComputation>(view_of(vertices_, faces_), grid, thickness, largest, options);
    });
  }

  nb::tuple field(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& size,
                  const nb::object& progress) {
    DistanceField made;
    double seconds = 0;
    watched_call(progress, [&](const ProgressCallback&) {
      const Timed timed(seconds);
      windows_->compute(size_of(first), size_of(size), made);
    });
    return nb::make_tuple(std::move(made), python::dict_of(windows_->report(), seconds));
  }

  bool is_reached(const std::array<std::int64_t, 3>& first, const std::array<std::int64_t, 3>& size) const {
    return windows_->is_reached(size_of(first), size_of(size));
  }
  bool is_whole() const { return windows_->is_whole(); }

 private:
  template <class Call>
  void watched_call(const nb::object& progress, const Call& call) {
    run_watched(progress, [&](const ProgressCallback& report) {
      const std::lock_guard one_call(calling_);
      report_ = report;
      try {
        call(report);
      } catch (...) {
        report_ = nullptr;
        throw;
      }
      report_ = nullptr;
    });
  }

  VertexInput vertices_;
  FaceInput faces_;
  std::mutex calling_;
  ProgressCallback report_;  // of the call at work
  std::unique_ptr<WindowComputation> windows_;
};

std::unique_ptr<Windows> prepare(const VertexInput& vertices, const FaceInput& faces, const GridInput& grid,
                                 double thickness, std::array<std::int64_t, 3> largest, const nb::handle& sign,
                                 const std::string& method, bool nearest, int threads, const std::string& device,
                                 std::int64_t memory_limit) {
  auto windows = std::make_unique<Windows>(vertices, faces);
  windows->prepare(grid.grid(), thickness, size_of(largest),
                   compute_options(sign, method, nearest, threads, device, memory_limit));
  return windows;
}

}  // namespace

void add_windows(nb::module_& m) {
  nb::class_<Windows>(m, "Windows")
      .def("field", &Windows::field, "first"_a, "shape"_a, "progress"_a.none())
      .def("is_reached", &Windows::is_reached, "first"_a, "shape"_a)
      .def_prop_ro("is_whole", &Windows::is_whole);
  m.def("windows", &prepare, "vertices"_a, "faces"_a, "grid"_a, "thickness"_a, "largest"_a, "sign"_a.none(), "method"_a,
        "nearest"_a, "threads"_a, "device"_a, "memory_limit"_a);
}

}  // namespace standoff::python
