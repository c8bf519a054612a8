// SPDX-License-Identifier: Apache-2.0
// algorithm_2.cu for the emulated GPU.
#include "backends/cuda/algorithm_2.cu"
