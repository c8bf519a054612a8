// SPDX-License-Identifier: Apache-2.0
// The field's kernels for any processor.
#include "field/cpu/kernels/table.inl"
