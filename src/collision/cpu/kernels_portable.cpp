// The queries' kernels for any processor.
#include "collision/cpu/kernels/table.inl"
