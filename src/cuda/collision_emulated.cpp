// Collision queries on the emulated GPU.
#include "cuda/collide.cuh"
#include "cuda/collision.h"
#include "cuda/sweep.cuh"

namespace standoff::emulated {

void collide(const collision::CollideJob& job) { run_collide(job, Backend::emulated); }
void sweep(const collision::SweepJob& job) { run_sweep(job, Backend::emulated); }

}  // namespace standoff::emulated
