"""The exceptions of the package. Every field is an attribute."""

from __future__ import annotations

from typing import Optional


class UmbrageError(ValueError):
    """Base of the exceptions that the package raises."""


class ArgumentError(UmbrageError):
    """An argument that cannot be used.

    Attributes
    ----------
    argument : str
        Its name.
    place : str or None
        Where in the array: "row 3, column 1", counted from 0.
    index : tuple of int or None
        The same as an index of the array: (3, 1).
    problem, remedy : str
        What is wrong, and what to do.
    """

    def __init__(
        self, argument: str, place: Optional[str], index: Optional[tuple[int, int]], problem: str, remedy: str
    ) -> None:
        super().__init__(argument, place, index, problem, remedy)
        self.argument = argument
        self.place = place
        self.index = index
        self.problem = problem
        self.remedy = remedy

    def __str__(self) -> str:
        place = f", {self.place}" if self.place else ""
        return f"{self.argument}{place}: {self.problem}; {self.remedy}"


class ReadError(UmbrageError):
    """A file that cannot be read.

    Attributes
    ----------
    file : str
        The file.
    format : str or None
        Its format, if it was detected.
    place : str or None
        Where in the file: "line 12", "byte 80", "accessor 3".
    line, byte : int or None
        The same as a number; lines count from 1, bytes from 0.
    problem, remedy : str
        What is wrong, and what to do.
    """

    def __init__(
        self,
        file: str,
        format: Optional[str],
        place: Optional[str],
        line: Optional[int],
        byte: Optional[int],
        problem: str,
        remedy: str,
    ) -> None:
        super().__init__(file, format, place, line, byte, problem, remedy)
        self.file = file
        self.format = format
        self.place = place
        self.line = line
        self.byte = byte
        self.problem = problem
        self.remedy = remedy

    def __str__(self) -> str:
        place = f", {self.place}" if self.place else ""
        format = f" ({self.format})" if self.format else ""
        return f"{self.file}{place}{format}: {self.problem}; {self.remedy}"


class RoundingWarning(UserWarning):
    """Rounding to ``float32`` moved coordinates by more than 2**-20 of the mesh's diagonal.

    Attributes
    ----------
    argument : str
        The array.
    largest : float
        How far a coordinate moved at most, in its own units.
    """

    def __init__(self, argument: str, largest: float) -> None:
        super().__init__(argument, largest)
        self.argument = argument
        self.largest = largest

    def __str__(self) -> str:
        return (
            f"{self.argument}: rounding to float32 moved a coordinate by {self.largest:.2g}; "
            "move the model towards the origin"
        )
