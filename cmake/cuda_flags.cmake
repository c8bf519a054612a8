# How nvcc compiles the kernels: arithmetic stays the CPU's, nothing is fused that the source does not fuse.
set(DIFI_CUDA_FLAGS --fmad=false --expt-relaxed-constexpr -Xcompiler=-ffp-contract=off -Xcompiler=-fno-math-errno)
