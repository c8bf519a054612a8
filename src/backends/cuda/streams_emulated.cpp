// SPDX-License-Identifier: Apache-2.0
// streams.cu for the emulated GPU.
#include "backends/cuda/streams.cu"
