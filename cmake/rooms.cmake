# SPDX-License-Identifier: Apache-2.0
# The files below src of the components that tests/gpu_check builds too, on machines where the rest of standoff is not built.
# One list for both: a folder that the library needs is then never missing there.
set(STANDOFF_GROUND_FILES core/*.cpp files/*.cpp geometry/*.cpp bvh/*.cpp)
set(STANDOFF_FIELD_FILES sign/*.cpp sign/*/*.cpp field/*.cpp field/cpu/*.cpp field/cuda/*.cpp points/*.cpp points/cpu/*.cpp
    sidecars/*.cpp sidecars/cpu/*.cpp voxels/*.cpp thesis/*.cpp approximate/*.cpp
    backends/fields.cpp backends/streams.cpp)
set(STANDOFF_FIELD_TABLES field/cpu/kernels/table.inl points/cpu/kernels/table.inl sidecars/cpu/kernels/sidecars.inl sign/cpu/kernels.inl)
set(STANDOFF_COLLISION_TABLES collision/cpu/kernels.inl)
set(STANDOFF_COLLISION_FILES collision/*.cpp collision/body/*.cpp collision/cpu/*.cpp thesis/algorithm_2*.cpp backends/collision.cpp)
