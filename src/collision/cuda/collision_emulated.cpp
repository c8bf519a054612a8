// Collision queries on the emulated GPU.
#include "collision/cuda/collide.cuh"
#include "collision/cuda/queries.h"
#include "collision/cuda/sweep.cuh"

namespace standoff::emulated {

void collide(const collision::CollideJob& job) { run_collide(job, Backend::emulated); }
void sweep(const collision::SweepJob& job) { run_sweep(job, Backend::emulated); }

}  // namespace standoff::emulated
