// SPDX-License-Identifier: Apache-2.0
// The kernels of sidecars for any processor.
#include "sidecars/cpu/kernels/sidecars.inl"
