#include "field/backend.h"

#include <array>

#include "cpu/thesis.h"
#include "cpu/tiles.h"

namespace difi {
namespace {

constexpr std::array kRows{
    BackendRow{Backend::cpu, Method::tiles, "cpu", "tiles", [] { return true; }, cpu::tiles_device, cpu::run_tiles,
               cpu::tiles_scratch_bytes},
    BackendRow{Backend::cpu, Method::thesis, "cpu", "thesis", [] { return true; }, cpu::thesis_device, cpu::run_thesis,
               cpu::thesis_scratch_bytes},
};

}  // namespace

std::span<const BackendRow> backends() { return kRows; }

const BackendRow& find_backend(Backend backend, Method method) {
  for (const BackendRow& row : kRows)
    if (row.method == method && (backend == Backend::automatic || row.backend == backend) && row.available())
      return row;
  if (backend == Backend::cuda)
    throw Error(ErrorCode::device, "compute: this build of difi has no CUDA backend; use the CPU (--device cpu)");
  throw Error(ErrorCode::device, "compute: no backend runs this method; use another method or backend");
}

}  // namespace difi
