// Collision queries on the emulated GPU.
#include "cuda/collide.cuh"
#include "cuda/collision.h"

namespace difi::emulated {

void collide(const collision::CollideJob& job) { run_collide(job, Backend::emulated); }

}  // namespace difi::emulated
