// SPDX-License-Identifier: Apache-2.0
// The devices of fields in device memory (standoff/cuda_compute.h).
#include <algorithm>
#include <array>
#include <utility>
#include <variant>
#include <vector>

#include "backends/cuda/fields.h"
#include "core/guarded.h"
#include "core/tile_count.h"
#include "field/backend.h"
#include "field/cuda/capacity.h"
#include "field/plan.h"
#include "gpu/devices.h"
#include "sign/plan.h"
#include "sign/sign_text.h"
#include "standoff/error.h"
#include "standoff/testing/emulation.h"
#include "standoff/version.h"

namespace standoff::cuda {
namespace {

struct StreamDevice {
  Backend backend;
  std::vector<OrError<Box>> (*bounds)(std::span<const MeshView>, const OnStream&);
  std::vector<OrError<FieldOutcome>> (*compute)(std::span<const FieldRequest>, const OnStream&);
  void (*copy)(const float*, std::span<float>, const OnStream&);
};

constexpr std::array kStreamRows{
    StreamDevice{Backend::cuda, bounds_on_stream, compute_on_stream, copy_from_stream},
#ifdef STANDOFF_HAVE_EMULATION
    StreamDevice{testing::kEmulated, emulated::bounds_on_stream, emulated::compute_on_stream,
                 emulated::copy_from_stream},
#endif
};

// Throws if there is no such device.
const BackendRow& backend_of(const OnStream& on, Method method) {
  if (on.backend != Backend::cuda && on.backend != testing::kEmulated)
    throw Error(ErrorCode::usage, "cuda: only Backend::cuda works on device memory; compute() takes what the CPU has");
  return find_backend(on.backend, method, 1, {{1, 1, 1}, {}});
}
const StreamDevice& device_of(const OnStream& on) {
  if (!on.memory.allocate != !on.memory.release)
    throw Error(ErrorCode::usage, "cuda: an allocator needs both functions, allocate and release; give both or none");
  const Backend backend = backend_of(on, Method::tiles).backend;
  return *std::find_if(kStreamRows.begin(), kStreamRows.end(),
                       [&](const StreamDevice& row) { return row.backend == backend; });
}

// Runs all inputs at once, or in halves if they do not fit into the device's memory.
template <class Answer, class Input>
std::vector<OrError<Answer>> in_halves(std::vector<OrError<Answer>> (*run)(std::span<const Input>, const OnStream&),
                                       std::span<const Input> all, const OnStream& on) {
  try {
    return run(all, on);
  } catch (const gpu::OutOfMemory& error) {
    if (all.size() < 2) return {OrError<Answer>(static_cast<const Error&>(error))};
  }
  const std::size_t half = all.size() / 2;
  std::vector<OrError<Answer>> answers = in_halves(run, all.first(half), on);
  for (auto& answer : in_halves(run, all.subspan(half), on)) answers.push_back(std::move(answer));
  return answers;
}

// Throws Error{usage}.
void check(const FieldRequest& request, const OnStream& on) {
  ComputeOptions options;
  options.method = request.method;
  options.nearest = request.nearest != nullptr;
  validate(request.thickness, options);
  validate(request.grid);
  check_grid(request.grid);
  validate(request.sign);
  if (!find_info(request.sign.method)->at_samples && request.sign.method != SignMethod::none)
    throw Error(
        ErrorCode::usage,
        "cuda: this sign method needs nearest triangles or changes distances, which the CPU does; take another, "
        "such as automatic, or copy the mesh to the CPU");
  if (request.sign.outer)
    throw Error(ErrorCode::usage,
                "cuda: the CPU alone leaves out internal triangles; leave out `outer`, or copy the mesh to the CPU");
  if (!request.values) throw Error(ErrorCode::usage, "cuda: the field is to be written to null; give device memory");
  if (!request.nearest && request.sidecars.any())
    throw Error(ErrorCode::usage,
                "cuda: sidecars are made from nearest triangles, but nearest is null; give it device memory for an "
                "index of each "
                "sample");
  backend_of(on, request.method);
}

ComputeReport report_of(const FieldRequest& request, const FieldOutcome& made, const OnStream& on) {
  const Outcome& outcome = made.outcome;
  const BackendRow& row = backend_of(on, request.method);
  ComputeReport report;
  report.method = find_info(row.method)->name;
  report.backend = name_of(row.backend);
  report.device = row.device({}, on.device);
  report.triangles = static_cast<std::int64_t>(request.mesh.triangles.size());
  report.samples = request.grid.sample_count();
  report.samples_examined = static_cast<std::int64_t>(outcome.samples_examined);
  report.samples_band = static_cast<std::int64_t>(outcome.samples_band);
  report.tiles = tile_count(request.grid.size);
  report.sign = made.sign;
  report.provenance = {report.method, 0, version(), written(sign_text_of(request.sign, made.sign))};
  return report;
}

}  // namespace

std::vector<OrError<Box>> bounds_of_each(std::span<const MeshView> meshes, const OnStream& on) try {
  return in_halves(device_of(on).bounds, meshes, on);
} catch (...) {
  throw_as_error("cuda");
}

std::vector<OrError<ComputeReport>> compute_each(std::span<const FieldRequest> requests, const OnStream& on) try {
  const StreamDevice& device = device_of(on);
  std::vector<OrError<ComputeReport>> answers(requests.size());
  std::vector<std::size_t> places;
  std::vector<FieldRequest> valid;
  for (std::size_t n = 0; n < requests.size(); ++n)
    answer_with(answers[n], [&] {
      check(requests[n], on);
      places.push_back(n);
      valid.push_back(requests[n]);
    });
  const std::vector<OrError<FieldOutcome>> outcomes = in_halves<FieldOutcome, FieldRequest>(device.compute, valid, on);
  for (std::size_t n = 0; n < valid.size(); ++n) {
    if (const Error* const error = std::get_if<Error>(&outcomes[n]))
      answers[places[n]] = *error;
    else
      answers[places[n]] = report_of(valid[n], std::get<FieldOutcome>(outcomes[n]), on);
  }
  return answers;
} catch (...) {
  throw_as_error("cuda");
}

void copy_to_host(const float* values, std::span<float> to, const OnStream& on) try {
  const StreamDevice& device = device_of(on);
  if (!values || !to.data()) throw Error(ErrorCode::usage, "cuda: values are copied from null or to null; give memory");
  device.copy(values, to, on);
} catch (...) {
  throw_as_error("cuda");
}

}  // namespace standoff::cuda
