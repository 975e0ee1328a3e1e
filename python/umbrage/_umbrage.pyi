from os import PathLike
from typing import Any, Literal, Optional, Sequence, Union, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._results import Ambient, Mesh, Prepared, Silhouette, Visible, Volume

_Path = Union[str, PathLike[str]]
_Light = Union[str, Sequence[float], NDArray[Any]]
_Weld = Union[Literal["exact", "none"], float]
_Scope = Literal["mesh", "primitive", "scene"]

__all__ = [
    "Oracle",
    "__version__",
    "ambient",
    "check",
    "check_arrays",
    "prepare",
    "read",
    "silhouette",
    "visible_fraction",
    "volume",
]
__version__: str

@final
class Oracle:
    def __new__(cls, vertices: ArrayLike, faces: ArrayLike) -> Oracle: ...
    @property
    def face_count(self) -> int: ...
    @property
    def rounding(self) -> float: ...
    def verdicts(self, points: ArrayLike, light: _Light) -> NDArray[np.uint8]: ...
    def visible_fraction(
        self, points: ArrayLike, light: _Light, *, normals: Optional[ArrayLike] = None
    ) -> Visible: ...

def ambient(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    method: Literal["rays", "exact"] = "rays",
    rays: int = 64,
    error: Optional[float] = None,
    seed: int = 1,
    distance: Optional[float] = None,
    falloff: Literal["none", "linear"] = "none",
    per: Literal["corner", "vertex", "face"] = "corner",
    bent: bool = False,
) -> Ambient: ...
def check(
    path: _Path,
    *,
    weld: _Weld = "exact",
    scope: _Scope = "mesh",
    require: Optional[Sequence[str]] = None,
    self_intersections: bool = False,
    limit: int = 5,
) -> dict[str, Any]: ...
def check_arrays(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    weld: _Weld = "exact",
    require: Optional[Sequence[str]] = None,
    self_intersections: bool = False,
    limit: int = 5,
) -> dict[str, Any]: ...
def prepare(
    vertices: ArrayLike,
    faces: ArrayLike,
    *,
    weld: _Weld = "exact",
    orient: bool = False,
    weld_within: Optional[float] = None,
    stitch: bool = False,
    split: bool = False,
    fill: Union[bool, int] = False,
    fill_anyway: bool = False,
) -> Prepared: ...
def read(path: _Path, *, scope: _Scope = "mesh") -> list[Mesh]: ...
def silhouette(
    vertices: ArrayLike,
    faces: ArrayLike,
    light: _Light,
    *,
    casting: Literal["all", "front"] = "all",
    weld: _Weld = "exact",
) -> Silhouette: ...
def visible_fraction(
    vertices: ArrayLike,
    faces: ArrayLike,
    points: ArrayLike,
    light: _Light,
    *,
    normals: Optional[ArrayLike] = None,
) -> Visible: ...
def volume(
    vertices: ArrayLike,
    faces: ArrayLike,
    light: _Light,
    *,
    casting: Literal["auto", "all", "front"] = "auto",
    caps: Literal["both", "none"] = "both",
    weld: _Weld = "exact",
) -> Volume: ...
