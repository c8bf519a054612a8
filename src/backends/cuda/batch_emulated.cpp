// SPDX-License-Identifier: Apache-2.0
// batch.cu for the emulated GPU.
#include "backends/cuda/batch.cu"
