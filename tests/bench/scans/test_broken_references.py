"""References for `bench motion` that are broken: named, never half measured."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from risorius.bench.scans import motion
from tests.heads import Stranger, stranger


@pytest.fixture(scope="module")
def arrays() -> dict[str, Any]:
    """A head that can be fitted, with one field of the right shape."""
    other: Stranger = stranger()
    return {
        "vertices": other.mesh.vertices,
        "triangles": other.mesh.faces,
        "landmarks68": other.landmarks,
        "jawOpen": np.ones_like(other.mesh.vertices),
    }


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("vertices", None, "has no array 'vertices'"),
        ("vertices", np.array(["a"]), "array 'vertices' holds no numbers"),
        ("vertices", np.full((9, 3), np.nan), "vertices must be finite"),
        ("triangles", np.full((9, 3), 10**6), "numbers of them"),
        ("landmarks68", np.arange(3), "landmarks68"),
        pytest.param(
            "jawOpen",
            np.zeros((3, 3)),
            "jawOpen in face.npz must be finite displacements",
            marks=pytest.mark.slow,
        ),
        pytest.param("jawOpen", None, "holds none of ARKit's shapes", marks=pytest.mark.slow),
    ],
)
def test_broken_references_are_named(
    arrays: dict[str, Any], tmp_path: Path, name: str, value: Any, message: str
) -> None:
    """The file, the array, and what it must be."""
    changed = {**arrays, name: value}
    np.savez(
        tmp_path / "face.npz", **{key: kept for key, kept in changed.items() if kept is not None}
    )
    with pytest.raises(ValueError, match=message):
        motion.measure(tmp_path)


@pytest.mark.parametrize("content", [b"hello", b"PK\x03\x04 cut short", b""])
def test_files_that_hold_no_arrays_are_named(tmp_path: Path, content: bytes) -> None:
    """Neither text nor half an archive is a traceback."""
    (tmp_path / "face.npz").write_bytes(content)
    with pytest.raises(ValueError, match=r"face.npz: is broken, or no file of arrays"):
        motion.measure(tmp_path)
