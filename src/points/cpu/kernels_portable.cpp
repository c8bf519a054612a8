// SPDX-License-Identifier: Apache-2.0
// The kernels of queries at points for any processor.
#include "points/cpu/kernels/table.inl"
