// The field's kernels for any processor.
#include "field/cpu/kernels/table.inl"
