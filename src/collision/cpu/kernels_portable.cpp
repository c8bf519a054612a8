// SPDX-License-Identifier: Apache-2.0
// The queries' kernels for any processor.
#include "collision/cpu/kernels.inl"
