"""Heads of a known topology (vertex numbering) need no landmark file."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.linalg import norm

from risorius import assets
from risorius.assets.coarse import coarse_head
from risorius.assets.data_files import read_toml
from risorius.assets.fitting import fit_head
from risorius.assets.fitting.landmark_file import LANDMARK_COUNT, MisfitError, UnfinishedError
from risorius.assets.fitting.topologies import recognised
from risorius.assets.meshes import Mesh

from ..heads import METRES_PER_MILLIMETRE, TURN_MATRIX, shape, user_head, write_topology

TABLE = read_toml(Path(assets.__file__).with_name("topologies.toml"))["topology"]


@pytest.fixture(autouse=True)
def _no_topologies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Put the user's folder of topologies inside the test's folder."""
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


def lumps(points):
    """One small triangle at each point (n, 3), like teeth or eyes: vertices (3 n, 3) and faces."""
    vertices = np.repeat(points, 3, axis=0) + np.tile(0.1 * np.eye(3), (len(points), 1))
    return vertices, np.arange(3 * len(points), dtype=np.int32).reshape(-1, 3)


def with_pieces_in_front(mesh):
    """The mesh behind two other pieces."""
    vertices, faces = lumps(np.array([[0.0, 0.0, -50.0], [9.0, 0.0, -50.0]]))
    both = np.vstack([faces, mesh.faces + len(vertices)]).astype(np.int32)
    return Mesh(np.vstack([vertices, mesh.vertices]), both)


def as_another(head):
    """The built-in head's vertices with another shape, unit and place."""
    return Mesh(shape(head.vertices) @ TURN_MATRIX.T * METRES_PER_MILLIMETRE, head.faces)


def test_our_own_heads_are_known_beside_other_pieces():
    """The project's heads are recognised in any shape, also with other pieces before them."""
    head = assets.load("head")
    known = recognised(with_pieces_in_front(as_another(head)))
    assert known.name == "the built-in head"
    assert np.array_equal(known.landmarks, head.landmarks + 6)
    coarse = coarse_head()
    known = recognised(Mesh(coarse.vertices, coarse.faces))
    assert known.name == "the coarse head"
    assert np.array_equal(known.landmarks, coarse.landmarks)


def test_a_known_head_is_fitted_without_a_landmark_file(tmp_path):
    """A known head is fitted as with a landmark file, and a line names the topology.

    For other meshes a line asks for landmarks.
    """
    other = replace(user_head(), mesh=as_another(assets.load("head")))
    mesh, marks = other.write(tmp_path)
    fitted = fit_head(mesh)
    assert np.array_equal(fitted.vertices, fit_head(mesh, marks).vertices)
    assert "its vertices are those of the built-in head" in fitted.notes[0]
    assert fitted.files == (mesh,)
    unknown, _ = user_head().write(tmp_path)
    with pytest.raises(UnfinishedError, match="needs a landmark file"):
        fit_head(unknown)


def test_the_table_is_sound():
    """Each entry has 68 existing vertices, and edge lengths relative to the face."""
    assert len(TABLE) >= 3
    for row in TABLE:
        fewest = min(vertices for vertices, _ in row["counts"])
        assert len(set(row["landmarks"])) == LANDMARK_COUNT and max(row["landmarks"]) < fewest
        for first, second, share in row.get("edges", ()):
            assert max(first, second) < fewest and 0.0 < share < 0.2


def test_edges_tell_meshes_of_the_same_counts_apart(tmp_path):
    """A user's topology is applied only to meshes with its edges, not just its vertex count."""
    other = user_head()
    mesh = other.mesh
    right, left = mesh.vertices[other.landmarks[[36, 45]]]
    width = norm(right - left)
    first, second = mesh.faces[0, :2].tolist()
    share = float(norm(mesh.vertices[first] - mesh.vertices[second]) / width)
    file = write_topology(tmp_path / "config", other, edges=[[first, second, share]])
    mine = json.loads(file.read_text())
    known = recognised(mesh)
    assert known.name == "mine" and np.array_equal(known.landmarks, other.landmarks)
    file.write_text(json.dumps(mine | {"edges": [[first, second, 9.0 * share]]}))
    assert recognised(mesh) is None
    file.write_text(json.dumps(mine | {"edges": [[first, len(mesh.vertices) - 1, share]]}))
    assert recognised(mesh) is None


def test_a_known_head_that_cannot_be_fitted_may_be_marked(tmp_path):
    """If a topology's landmarks do not fit a mesh, the error suggests marking the landmarks."""
    other = user_head()
    write_topology(tmp_path / "config", other, landmarks=list(range(LANDMARK_COUNT)))
    mesh, marks = other.write(tmp_path)
    with pytest.raises(MisfitError, match=r"those of mine, .*; but .*; else mark") as raised:
        fit_head(mesh)
    assert isinstance(raised.value, UnfinishedError)
    assert fit_head(mesh, marks).notes == ()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"landmarks": [1, 2]}, "mine.json, 'landmarks': has 2 vertex indices, must have 68"),
        ({"counts": [[40, 9]]}, "'landmarks': has vertex 67; 'counts' must have more vertices"),
        ({"counts": 7}, "mine.json, 'counts'"),
        ({"edges": [[1, 900, 0.1]]}, "'edges': has vertex 900; 'counts' must have more vertices"),
    ],
)
def test_a_wrong_topology_is_one_line(tmp_path, change, message):
    """A wrong topology file is reported in one line: file, value, and allowed values."""
    whole = {"counts": [[100, 200]], "landmarks": list(range(LANDMARK_COUNT))}
    write_topology(tmp_path / "config", user_head(), **whole | change)
    with pytest.raises(assets.AssetError, match=message) as raised:
        recognised(user_head().mesh)
    assert "\n" not in str(raised.value)
