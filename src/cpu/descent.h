// Which triangles each brick has to look at when the thickness is large or infinite: candidates handed down from
// coarse cells to fine ones, and culled on the way (docs/tiles.md).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "cpu/kernels.h"
#include "cpu/lattice.h"
#include "field/backend.h"

namespace difi::cpu {

/// Calls use(brick, triangles) for every brick that may hold samples within the thickness, from many threads. The
/// triangles are mesh indices: at least all those that are nearest to some sample of the brick within the thickness.
void for_each_brick_by_descent(const Job& job, const Lattice& lattice, const Kernels& kernels,
                               const std::function<void(std::int64_t, std::span<const std::uint32_t>)>& use);

/// Bytes that for_each_brick_by_descent may hold, its lists of candidates counted once for each triangle.
std::int64_t descent_scratch_bytes(std::int64_t triangles);

}  // namespace difi::cpu
