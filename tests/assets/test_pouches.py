"""A pouch behind the lips of a file is removed."""

from dataclasses import replace

import numpy as np
import pytest

from risorius.assets.fitting import fit
from risorius.assets.fitting.mesh_validation import SkinPiece, rim_behind
from risorius.assets.topology import grid_faces
from tests.heads import closed, user_head


@pytest.mark.slow
def test_a_pouch_behind_the_lips_is_removed():
    """A pouch behind the lips of the file is removed for the built-in mouth.

    The outer skin keeps its landmarks and vertex indices.
    """
    other = user_head()
    bagged = closed(other.mesh, other.landmarks[60:68])
    vertices = bagged.vertices.copy()
    vertices[-1, 1] -= 0.04  # back, in the axes of this head
    bagged = replace(bagged, vertices=vertices)
    head = fit(bagged, other.landmarks)
    assert len(other.mesh.vertices) not in head.file_vertices
    assert len(head.faces) > 0.95 * len(other.mesh.faces)
    assert np.array_equal(head.file_vertices[head.landmarks], other.landmarks)


def test_the_rim_of_a_pouch_ends_along_a_row_of_vertices():
    """What stays of a pouch behind the lips is whole rows of a regular mesh, without saw teeth."""
    columns = 20
    depths = np.array([0.0, 2.0, 4.0, 7.0, 12.0])  # [mm] of the rows behind the lips' edge
    depth, across = np.meshgrid(depths, np.linspace(-20.0, 20.0, columns), indexing="ij")
    wave = 0.5 * (-1.0) ** np.arange(columns)  # every second vertex of a row lies deeper
    ahead = -depth - wave * (depth == depths[2])
    vertices = np.stack([across, np.zeros_like(across), ahead], axis=2).reshape(-1, 3)
    faces = grid_faces(np.arange(len(vertices)).reshape(len(depths), columns))
    none = np.zeros(0, np.int32)
    skin = SkinPiece(vertices, faces, none, none, none)
    row = np.repeat(np.arange(len(depths)), columns)
    rim = rim_behind(skin, row == 0, row > 0)
    assert np.array_equal(rim, (row == 1) | (row == 2))
