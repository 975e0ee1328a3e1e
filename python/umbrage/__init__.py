"""Meshes into verified shadows: crack reports, exact silhouettes, closed shadow volumes, an exact ray cast.

Arrays go in as (n, 3) vertices and (m, 3) faces, and come out as numpy arrays. Everything is exact with respect
to ``float32`` positions: what rounding to them moved is reported.
"""

from ._errors import ArgumentError, ReadError, RoundingWarning, UmbrageError
from ._umbrage import __version__, check, check_arrays

__all__ = [
    "ArgumentError",
    "ReadError",
    "RoundingWarning",
    "UmbrageError",
    "__version__",
    "check",
    "check_arrays",
]
