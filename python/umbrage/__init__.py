"""Meshes into verified shadows: crack reports, exact silhouettes, closed shadow volumes, an exact ray cast.

Arrays go in as vertices of shape (n, 3) and faces of shape (m, 3), and come out as numpy arrays. Everything is
exact with respect to ``float32`` positions. ``float32`` in C order is read in place; anything else is rounded
once: ``rounding`` of a result is how far a coordinate moved at most, and a `RoundingWarning` says so where that
is more than 2**-20 of the mesh's diagonal. Bad arguments raise an `ArgumentError`, unreadable files a
`ReadError`; both name the place. All work is done without the interpreter's lock, on all processors; results
are the same bytes whatever their number.

Functions: `check`, `check_arrays`, `prepare`, `silhouette`, `volume`, `ambient`, `visible_fraction`, `read`;
the class `Oracle`. `umbrage.shapes` has small meshes, `umbrage.strategies` those for property tests.
"""

from . import shapes
from ._errors import ArgumentError, ReadError, RoundingWarning, UmbrageError
from ._results import Ambient, Mesh, Prepared, Silhouette, Verdict, Visible, Volume
from ._umbrage import (
    Oracle,
    __version__,
    ambient,
    check,
    check_arrays,
    prepare,
    read,
    silhouette,
    visible_fraction,
    volume,
)

__all__ = [
    "Ambient",
    "ArgumentError",
    "Mesh",
    "Oracle",
    "Prepared",
    "ReadError",
    "RoundingWarning",
    "Silhouette",
    "UmbrageError",
    "Verdict",
    "Visible",
    "Volume",
    "__version__",
    "ambient",
    "check",
    "check_arrays",
    "prepare",
    "read",
    "shapes",
    "silhouette",
    "visible_fraction",
    "volume",
]
