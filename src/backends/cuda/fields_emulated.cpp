// SPDX-License-Identifier: Apache-2.0
// fields.cu for the emulated GPU.
#include "backends/cuda/fields.cu"
