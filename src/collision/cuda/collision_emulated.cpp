// SPDX-License-Identifier: Apache-2.0
// collision.cu for the emulated GPU.
#include "collision/cuda/collision.cu"
