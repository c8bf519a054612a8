// SPDX-License-Identifier: Apache-2.0
// Fields in device memory with workspace and waiting taken care of (standoff/cuda_compute.h). nvcc compiles this file
// for CUDA; streams_emulated.cpp compiles it for the emulation.
#include "backends/cuda/fields.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/threads.h"
#include "field/cuda/any_mesh.cuh"
#include "field/prepare.h"
#include "gpu/devices.h"
#include "gpu/platform.cuh"
#include "sidecars/cuda/sidecars.cuh"
#include "sign/cuda/sign_values.cuh"
#include "sign/plan.h"
#include "sign/sign_text.h"
#include "standoff/occupancy.h"

namespace standoff::STANDOFF_PLATFORM {
namespace {

using cuda::answer_with, cuda::FieldOutcome, cuda::FieldRequest, cuda::OnStream, cuda::OrError;

// Device memory that a caller's allocator gives, or CUDA itself. It is replaced if it is too small; then its content is
// lost. No work on it may be left when it is replaced or freed.
class CallerMemory {
 public:
  explicit CallerMemory(const cuda::Allocator& from) : from_(from) {}
  ~CallerMemory() { give_back(); }
  CallerMemory(const CallerMemory&) = delete;
  CallerMemory& operator=(const CallerMemory&) = delete;

  // Returns room for `count` elements. Throws gpu::OutOfMemory, and Error{usage} if the allocator's memory is not
  // aligned.
  template <class T>
  T* room_for(std::int64_t count) {
    if (!from_.allocate) return own_.room_for<T>(count);
    const std::int64_t bytes = count * static_cast<std::int64_t>(sizeof(T));
    if (bytes > bytes_) {
      give_back();
      take(bytes);
    }
    return static_cast<T*>(given_);
  }
  // How much there is; as much or more than was asked for.
  std::int64_t bytes() const { return from_.allocate ? bytes_ : own_.bytes(); }

 private:
  void take(std::int64_t bytes) {
    given_ = from_.allocate(bytes);
    if (!given_)
      throw gpu::OutOfMemory(ErrorCode::limit,
                             "cuda: the caller's allocator has no " + std::to_string((bytes + (1 << 20) - 1) >> 20) +
                                 " MiB of the GPU's memory; free some, or use the CPU",
                             {.bytes_needed = bytes});
    if (reinterpret_cast<std::uintptr_t>(given_) % gpu::Workspace::kAlignment != 0) {
      give_back();
      throw Error(ErrorCode::usage, "cuda: the allocator's memory is not aligned to " +
                                        std::to_string(gpu::Workspace::kAlignment) +
                                        " bytes; give aligned memory, as cudaMalloc does");
    }
    bytes_ = bytes;
  }
  void give_back() {
    if (given_) from_.release(given_);
    given_ = nullptr;
    bytes_ = 0;
  }

  cuda::Allocator from_;
  Growing own_;
  void* given_ = nullptr;
  std::int64_t bytes_ = 0;
};

// Makes the device the current one, and waits for work that still writes to the input.
struct Begun : DeviceScope {
  explicit Begun(const OnStream& on) : DeviceScope(on.device) {
    for (const Stream other : on.after) wait_for(other);
  }
};

// The valid meshes of a call, packed in one piece of device memory, with the boxes around them. The error of any other
// mesh becomes its answer.
class Meshes {
 public:
  struct One {
    std::size_t place;  // the index of its view
    PackedMesh packed;
    Box box;
  };

  // view_of(place) returns a mesh's view. Waits for the stream.
  template <class Answer, class ViewOf>
  Meshes(std::vector<OrError<Answer>>& answers, const OnStream& on, const ViewOf& view_of)
      : memory_(on.memory), found_(answers.size()) {
    const Stream stream = on.stream;
    gpu::Workspace measure(nullptr);
    const std::int64_t known = laid_out(answers, measure, view_of).empty() ? 0 : measure.used();
    if (known == 0) return;
    gpu::Workspace room(memory_.room_for<char>(known));
    all_ = laid_out(answers, room, view_of);
    fill_bytes(stream, found_on_device_, 0xff, found_bytes());
    for (const One& one : all_) {
      one.packed.pack(stream);
      find_box(one.packed.mesh(), found_on_device_ + one.place, stream);
    }
    look(stream);
    std::vector<One> good;
    for (const One& one : all_)
      answer_with(answers[one.place], [&] { good.push_back({one.place, one.packed, box_of(found_[one.place])}); });
    all_ = std::move(good);
  }

  const std::vector<One>& all() const { return all_; }
  Outcome* outcome_on_device(std::size_t place) const { return &found_on_device_[place].outcome; }
  /// The outcome at the last look().
  const Outcome& outcome(std::size_t place) const { return found_[place].outcome; }
  /// Waits for the stream, and copies its findings.
  void look(Stream stream) {
    wait_for(stream);
    copy_out(found_.data(), found_on_device_, found_bytes());
  }

 private:
  std::int64_t found_bytes() const { return static_cast<std::int64_t>(found_.size() * sizeof(Found)); }

  template <class Answer, class ViewOf>
  std::vector<One> laid_out(std::vector<OrError<Answer>>& answers, gpu::Workspace& room, const ViewOf& view_of) {
    found_on_device_ = room.take<Found>(static_cast<std::int64_t>(found_.size()));
    std::vector<One> all;
    for (std::size_t n = 0; n < answers.size(); ++n)
      answer_with(answers[n], [&] { all.push_back({n, PackedMesh(view_of(n), room), {}}); });
    return all;
  }

  CallerMemory memory_;
  std::vector<One> all_;
  std::vector<Found> found_;
  Found* found_on_device_ = nullptr;
};

// A field that is not finished yet, and the number of list entries that it asked for.
struct Wanted {
  std::size_t place;
  Task task;
  std::int64_t entries;

  std::int64_t bytes() const { return STANDOFF_PLATFORM::workspace_bytes(task, entries); }
  // Returns whether the lists did not fit, and then asks for more entries.
  bool wants_more(const Outcome& seen) {
    const bool is_short = seen.stopped != 0 && seen.bad_triangle == Outcome::kNone &&
                          seen.needed_entries < Outcome::kNoOrder &&
                          seen.needed_entries > static_cast<unsigned long long>(entries);
    // The number needed is a lower bound: ask for half as much again.
    if (is_short) entries = static_cast<std::int64_t>(seen.needed_entries + seen.needed_entries / 2);
    return is_short;
  }
};

// Puts the fields on the stream, all in one workspace, and waits for it.
void compute_once(std::span<const Wanted> wanted, CallerMemory& workspace, Meshes& meshes, Stream stream) {
  std::vector<Task> tasks;
  std::int64_t needed = 0;
  for (const Wanted& one : wanted) {
    tasks.push_back(one.task);
    needed = std::max(needed, one.bytes());
  }
  char* const memory = workspace.room_for<char>(needed);
  STANDOFF_PLATFORM::enqueue(tasks, memory, workspace.bytes(), stream);
  meshes.look(stream);
}

Mesh copied(const DeviceMesh& mesh) {
  Mesh copy;
  copy.vertices.resize(static_cast<std::size_t>(mesh.vertex_count));
  copy.triangles.resize(static_cast<std::size_t>(mesh.triangle_count));
  copy_out(copy.vertices.data(), mesh.vertices, mesh.vertex_count * static_cast<std::int64_t>(sizeof(Vec3)));
  copy_out(copy.triangles.data(), mesh.triangles, mesh.triangle_count * static_cast<std::int64_t>(sizeof(Triangle)));
  return copy;
}

// Decides a sign on the host, and gives it to values whose magnitudes are right. Waits for the stream.
SignReport sign_by_host(const DeviceMesh& mesh, const FieldRequest& request, CallerMemory& room, Stream stream) {
  const Occupancy found = occupancy(copied(mesh), request.grid, {.sign = request.sign});
  const auto bytes = static_cast<std::int64_t>(found.bits.size());
  unsigned char* const bits = room.room_for<unsigned char>(bytes);
  copy_in_later(bits, found.bits.data(), bytes, stream);
  const Size3& size = request.grid.size;
  launch(stream, "sign by bits", sign_by_bits, std::min<std::int64_t>(kManyBlocks, bytes / kSignThreads + 1),
         kSignThreads, bits, found.row_bytes(), size.y * size.z, size.x, request.values);
  wait_for(stream);
  return found.sign;
}

// Makes the sidecars of a field whose values have got this sign from the host. Waits for the stream.
void make_sidecars(const Task& task, const SignText& sign, CallerMemory& room, Stream stream) {
  SurfaceNormals normals{sign.method != SignMethod::none, sign.invert, nullptr};
  std::vector<std::int8_t> use;
  if (task.sidecars.gradient && sign.oriented)  // in threads of its own, as the caller may be a task that is cancelled
    use = Threads(0).run([&] { return orientation_of(copied(task.mesh), sign); });
  if (!use.empty()) {
    const auto bytes = static_cast<std::int64_t>(use.size());
    auto* const on_device = room.room_for<std::int8_t>(bytes);
    copy_in_later(on_device, use.data(), bytes, stream);
    normals.use = on_device;
  }
  enqueue_sidecars(task, normals, stream);
  wait_for(stream);
}

}  // namespace

std::vector<OrError<Box>> bounds_on_stream(std::span<const MeshView> views, const OnStream& on) {
  const Begun begun(on);
  std::vector<OrError<Box>> answers(views.size());
  const Meshes meshes(answers, on, [&](std::size_t n) { return views[n]; });
  for (const Meshes::One& one : meshes.all()) answers[one.place] = one.box;
  return answers;
}

std::vector<OrError<FieldOutcome>> compute_on_stream(std::span<const FieldRequest> requests, const OnStream& on) {
  const Begun begun(on);
  std::vector<OrError<FieldOutcome>> answers(requests.size());
  Meshes meshes(answers, on, [&](std::size_t n) { return requests[n].mesh; });
  std::vector<Wanted> wanted;
  for (const Meshes::One& one : meshes.all())
    answer_with(answers[one.place], [&] {
      const FieldRequest& r = requests[one.place];
      check_domain(one.box, r.grid);
      Task task{one.packed.mesh(),
                r.grid,
                r.thickness,
                r.method,
                {.values = r.values, .nearest = r.nearest},
                meshes.outcome_on_device(one.place)};
      const bool on_device = is_sign_on_device(r.sign);
      if (on_device) task.sign = r.sign;
      // Where the host decides the sign they are made after it: gradients have the sign of the values.
      if (on_device || r.sign.method == SignMethod::none) task.sidecars = r.sidecars;
      wanted.push_back(
          {one.place, task, cuda::likely_entries(task.mesh.triangle_count, task.grid, task.thickness, task.method)});
    });
  std::vector<Wanted> left_to_host;
  CallerMemory workspace(on.memory);
  while (!wanted.empty()) {
    compute_once(wanted, workspace, meshes, on.stream);
    std::vector<Wanted> again;
    for (Wanted& one : wanted) {
      FieldOutcome made;
      made.outcome = meshes.outcome(one.place);
      if (one.wants_more(made.outcome)) {
        again.push_back(one);
        continue;
      }
      const bool on_device = one.task.sign.method != SignMethod::none;
      if (on_device && made.outcome.doubts == 0)
        made.sign = plan_of_closed(SignMethod::winding).report;
      else if (on_device || requests[one.place].sign.method != SignMethod::none)
        left_to_host.push_back(one);
      made.outcome.doubts = 0;  // the host decides them
      answer_with(answers[one.place], [&] {
        cuda::check(made.outcome, one.task);
        answers[one.place] = made;
      });
    }
    wanted = std::move(again);
  }
  for (Wanted& one : left_to_host)
    answer_with(answers[one.place], [&] {
      const FieldRequest& request = requests[one.place];
      FieldOutcome* const found = std::get_if<FieldOutcome>(&answers[one.place]);
      if (!found) return;
      found->sign = sign_by_host(one.task.mesh, request, workspace, on.stream);
      one.task.sidecars = request.sidecars;
      if (request.sidecars.any())
        make_sidecars(one.task, sign_text_of(request.sign, found->sign), workspace, on.stream);
    });
  return answers;
}

void copy_from_stream(const float* values, std::span<float> to, const OnStream& on) {
  const Begun begun(on);
  wait_for(on.stream);
  copy_out(to.data(), values, static_cast<std::int64_t>(to.size_bytes()));
}

}  // namespace standoff::STANDOFF_PLATFORM
