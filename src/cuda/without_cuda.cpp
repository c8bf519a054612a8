// What stands for the CUDA backend where standoff is built without a CUDA compiler.
#include "core/guarded.h"
#include "cuda/backend.h"
#include "cuda/collision.h"
#include "standoff/cuda.h"

namespace standoff::cuda {
namespace {

constexpr const char* kWhyNot = "this build of standoff has no CUDA backend (it was built without nvcc)";

[[noreturn]] void fail() try { throw Error(ErrorCode::device, why_not_available()); } catch (...) {
  throw_as_error("cuda");
}

}  // namespace

bool available() { return false; }
std::string why_no_device() try { return kWhyNot; } catch (...) {
  throw_as_error("cuda");
}
std::string why_not_available() {
  return std::string("cuda: ") + kWhyNot + "; use the CPU (--device cpu), or build it where nvcc is (docs/cuda.md)";
}
std::string device_name(int) { return "no device"; }
std::vector<DeviceInfo> devices() { return {}; }

Counts run_tiles(const Job&, Sink&) { fail(); }
Counts run_thesis(const Job&, Sink&) { fail(); }
void collide(const collision::CollideJob&) { fail(); }
void sweep(const collision::SweepJob&) { fail(); }

std::int64_t workspace_bytes(std::int64_t, const Grid&, double, Method, std::int64_t) { fail(); }
void enqueue(const Task&, void*, std::int64_t, Stream) { fail(); }
void enqueue(std::span<const Task>, void*, std::int64_t, Stream) { fail(); }

}  // namespace standoff::cuda
