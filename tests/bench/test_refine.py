"""The benchmark of the refiners measures what it says."""

from __future__ import annotations

import builtins
import gc
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from risorius.bench import refine
from risorius.bench.peers import peers_for
from risorius.bench.waving_meshes import waving_mesh
from risorius.refine import connect, create


@pytest.mark.slow
def test_rows() -> None:
    """Ours with the share of edges that was asked for, and peers; times that fit."""
    report = refine.measure(["2k"], 0.05)
    rows = {row.method: row for row in report.rows}
    count = rows["kahler 10 %"].triangles_in
    assert abs(count - 2_000) < 100
    by_share = [rows[f"kahler {share} %"].triangles_out / count for share in (10, 50, 100)]
    assert 1.2 < by_share[0] < 2.0 < by_share[1] < 4.0 < by_share[2] < 7.0
    assert rows["sparse Loop 1x, numba"].triangles_out == 4 * count
    assert rows["sparse Loop 2x, numba"].triangles_out == 16 * count
    for row in report.rows:
        assert 0.0 < row.best_milliseconds <= row.milliseconds
        assert np.isclose(row.nanoseconds_per_triangle * row.triangles_out, 1e6 * row.milliseconds)
    assert gc.isenabled()


def test_waving_meshes() -> None:
    """A grid is one piece with four borders, no triangle twice."""
    load = waving_mesh("grid", 3_000)
    mesh = connect(load.faces, len(load.rest))
    assert len(load.rest) - len(mesh.edges) + len(load.faces) == 1 - 3
    assert np.array_equal(np.unique(load.faces), np.arange(len(load.rest)))
    corners = load.rest[load.faces]
    assert (np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] > 0).all()


@pytest.mark.parametrize("levels", [1, 2])
def test_sparse_loop_is_loop(levels: int) -> None:
    """The matrices give what our uniform Loop gives."""
    load = waving_mesh("grid", 600)
    ours = create("loop", load.faces, load.rest, levels=levels).refine(load.frames[1])
    peer = peers_for(load, 900)[0][levels - 1]
    assert peer.triangles == len(ours.triangles)
    rows = np.asarray(peer.call(load.frames[1]))
    assert np.allclose(np.sort(rows[:, 2]), np.sort(ours.positions[:, 2]), atol=2e-5)
    assert np.allclose(np.sort(rows[:, 5]), np.sort(ours.normals[:, 2]), atol=2e-4)


def test_missing_peers_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without VTK its row is left out, and one line says so."""
    found = builtins.__import__

    def without_vtk(
        name: str,
        globals_: Mapping[str, Any] | None = None,
        locals_: Mapping[str, Any] | None = None,
        names: Sequence[str] = (),
        level: int = 0,
    ) -> Any:
        if name.startswith("vtkmodules"):
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        return found(name, globals_, locals_, names, level)

    monkeypatch.setattr(builtins, "__import__", without_vtk)
    peers, missing = peers_for(waving_mesh("grid", 600), 900)
    left_out = "left out, vtkmodules is not installed (extra 'peers')"
    assert missing == [
        f"VTK adaptive: {left_out}",
        f"VTK adaptive, whole frame: {left_out}",
    ]
    assert "VTK adaptive" not in [peer.name for peer in peers]
    assert "trimesh Loop 1x" in [peer.name for peer in peers]
