"""The crack report."""

import numpy as np
import pytest

import umbrage

CUBE_VERTICES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_FACES = np.array(
    [
        [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
        [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
    ]
)  # fmt: skip


def test_cube_is_sound():
    report = umbrage.check_arrays(CUBE_VERTICES, CUBE_FACES)
    assert report["verdict"] == "sound"
    assert (report["faces"], report["edges"], report["signed_volume"]) == (12, 18, 8.0)
    assert report["defects"] == []
    # Fault injected: a face turned over.
    turned = CUBE_FACES.copy()
    turned[3] = turned[3][::-1]
    assert umbrage.check_arrays(CUBE_VERTICES, turned)["verdict"] == "cracked"
