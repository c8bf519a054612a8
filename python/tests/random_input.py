# SPDX-License-Identifier: Apache-2.0
"""What fuzz_test.py draws: arrays of every type and layout, as meshes and points."""

import warnings

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

floats = st.floats(-4, 4, width=32) | st.sampled_from(
    [0.0, -0.0, 1.0, 1e-30, 5e-324, 1e30, 1e308, np.nan, np.inf, -np.inf]
)
tame = st.integers(-8, 8).map(lambda n: n / 4)
vertex_types = st.sampled_from(
    [
        np.float32,
        np.float64,
        np.float16,
        np.int32,
        np.int8,
        np.uint64,
        ">f4",
        ">f8",
        np.longdouble,
        bool,
        complex,
        object,
        "U3",
    ]
)
face_types = st.sampled_from(
    [np.int32, np.uint32, np.int64, np.uint64, np.int8, np.uint8, np.int16, ">i4", ">u8", np.float32, bool, object]
)
shapes_of_rows = st.tuples(st.integers(0, 9), st.just(3)) | arrays.array_shapes(
    min_dims=0, max_dims=3, min_side=0, max_side=4
)


@st.composite
def laid_out(draw, array):
    """The array, its memory laid out in some way."""
    if array.ndim == 0:
        return array
    layout = draw(st.integers(0, 5))
    if layout == 1:
        return np.asfortranarray(array)
    if layout == 2:
        return np.repeat(array, 2, axis=0)[::2]
    if layout == 3:
        return array[::-1]
    if layout == 4 and array.dtype.kind in "fiu":
        memory = np.zeros(array.nbytes + 1, np.uint8)
        shifted = memory[1:].view(array.dtype).reshape(array.shape)
        shifted[...] = array
        return shifted
    if layout == 5:
        return array.tolist()
    return array


@st.composite
def any_vertices(draw):
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        array = draw(arrays.arrays(np.float64, draw(shapes_of_rows), elements=floats)).astype(draw(vertex_types))
    return draw(laid_out(array))


@st.composite
def any_faces(draw):
    wild = st.sampled_from([-1, -(2**31), 2**31, 2**32, 2**32 + 1, 2**63 - 1, -(2**63)])
    array = draw(arrays.arrays(np.int64, draw(shapes_of_rows), elements=st.integers(0, 8) | wild)).astype(
        draw(face_types)
    )
    return draw(laid_out(array))


@st.composite
def good_meshes(draw):
    """Any triangles over a few vertices: degenerate, crossing, open, turned."""
    vertices = draw(arrays.arrays(np.float64, st.tuples(st.integers(3, 8), st.just(3)), elements=tame))
    faces = draw(
        arrays.arrays(np.int32, st.tuples(st.integers(1, 10), st.just(3)), elements=st.integers(0, len(vertices) - 1))
    )
    return vertices, faces
