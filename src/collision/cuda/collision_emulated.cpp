// collision.cu for the emulated GPU.
#include "collision/cuda/collision.cu"
