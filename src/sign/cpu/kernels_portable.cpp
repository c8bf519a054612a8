// SPDX-License-Identifier: Apache-2.0
// The sign's kernels for any processor.
#include "sign/cpu/kernels.inl"
