# SPDX-License-Identifier: Apache-2.0
"""Fields by Dask: windows of a grid are the tasks of a cluster (docs/scale.md).

Needs the extra ``standoff[dask]``. Every window has the bits that it has in the whole field, so neither the cluster nor
the order of its work can be seen in the result.
"""

try:
    import dask.array  # noqa: F401
except ImportError as error:
    raise ImportError(
        f"standoff.dask needs {error.name}, which is not installed; pip install 'standoff[dask]'", name=error.name
    ) from None

from ._batch import batch
from ._compute import compute
from ._write import Written, write

__all__ = ["Written", "batch", "compute", "write"]
