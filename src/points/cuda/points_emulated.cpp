// SPDX-License-Identifier: Apache-2.0
// points.cu for the emulated GPU.
#include "points/cuda/points.cu"
