"""The body of a file: pieces on the skin move with the skin below their own roots."""

import numpy as np
from numpy.testing import assert_allclose

from risorius.app.rig.file_body import FileBody
from risorius.app.rig.pieces import FilePiece
from risorius.app.rig.poses import rest_in
from risorius.app.scenes import FaceScene
from risorius.assets.coarse import coarse_head
from risorius.assets.fitting import fit
from risorius.assets.meshes import Mesh

NOSE = 30  # landmarks
UPPER_LIP = 51
LOWER_LIP = 57
CHIN = 8
ROOTS = (CHIN, UPPER_LIP, NOSE, LOWER_LIP)
# A strip of two triangles that stands on the skin [mm].
STRAND = np.array([[0.0, 0.0, 0.2], [0.4, 0.0, 2.0], [0.0, 0.3, 4.0], [0.4, 0.3, 6.0]])


def test_mixed_strands_move_as_each_would_alone():
    """Strands whose vertices are mixed in the file follow their own roots, not each other's."""
    known = coarse_head()
    head = fit(Mesh(known.vertices, known.faces), known.landmarks)
    roots = known.vertices[known.landmarks[list(ROOTS)]]
    strands = STRAND[:, None] + roots  # the first points of all strands, then the second ones
    first = len(known.vertices)
    members = first + np.arange(STRAND.shape[0] * len(ROOTS)).reshape(STRAND.shape[0], -1)
    triangles = members.T[:, [[0, 1, 2], [1, 3, 2]]].reshape(-1, 3)
    vertices = np.vstack([known.vertices, strands.reshape(-1, 3)])
    mesh = Mesh(vertices, np.vstack([known.faces, triangles]).astype(np.int32))
    pose = rest_in(FaceScene(head), {"jawOpen": 1.0})

    def body_of(strand):
        piece = FilePiece(2, strand, "on_skin", roots[0])
        return FileBody(mesh, head, [piece], eyes_are_nodes=True)

    together = body_of(members.ravel())
    moved = together.at(pose)
    lowered = {}
    for landmark, strand in zip(ROOTS, members.T, strict=True):
        alone = body_of(strand).at(pose)
        assert_allclose(moved[strand], alone[strand], atol=1e-9)
        lowered[landmark] = (together.rest - moved)[strand, 1]
    assert lowered[CHIN].min() > 15.0
    assert lowered[LOWER_LIP].min() > 10.0
    assert np.abs(lowered[NOSE]).max() < 0.5
