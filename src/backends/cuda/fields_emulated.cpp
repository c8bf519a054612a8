// fields.cu for the emulated GPU.
#include "backends/cuda/fields.cu"
