"""The base class of refiners, used by an external subclass."""

from typing import Any, Unpack

import numpy as np
import pytest
from numpy.testing import assert_allclose

from risorius import refine
from tests import meshes
from tests.refine.border.test_stream import stream_for
from tests.refine.cases import sound_frame


class Middles(refine.BaseRefiner):
    """A refiner that cuts every triangle into three, around a new point in its middle."""

    def __init__(
        self,
        faces: Any,
        rest_positions: Any,
        *,
        raised: float = 0.0,
        **values: Unpack[refine.Values],
    ) -> None:
        super().__init__(faces, rest_positions, **values)
        self.raised = raised
        self.cut = np.flatnonzero(~self.connectivity.is_degenerate)

    @property
    def vertex_capacity(self) -> int:
        """The number of wedges, and one point for each triangle."""
        return len(self.connectivity.wedge_vertices) + len(self.cut)

    @property
    def triangle_capacity(self) -> int:
        """Three triangles for each triangle."""
        return 3 * len(self.connectivity.faces)

    def fill(self, stream: refine.Stream, view: refine.View | None) -> tuple[int, int]:
        """Reserve room for the worst case, and return the numbers of written rows."""
        mesh = self.connectivity
        wedge_count = len(self.connectivity.wedge_vertices)
        out = self.reserve(stream, self.vertex_capacity, self.triangle_capacity)
        self.find_normals()
        out.vertices[: len(self.points), :3] = self.points
        out.vertices[: len(self.points), 3:6] = self.normals
        self.write_wedges(out.vertices)
        middles = out.vertices[wedge_count : self.vertex_capacity]
        middles[:] = out.vertices[mesh.corners[self.cut]].mean(axis=1)
        lengths = np.linalg.norm(middles[:, 3:6], axis=1, keepdims=True)
        middles[:, 3:6] /= np.where(lengths > 0.0, lengths, 1.0)
        middles[:, :3] += self.raised * middles[:, 3:6]
        triangles = [mesh.corners[mesh.is_degenerate]]
        source = [np.flatnonzero(mesh.is_degenerate)]
        for k in range(3):
            ends = mesh.corners[self.cut][:, [k, (k + 1) % 3]]
            numbers = wedge_count + np.arange(len(self.cut), dtype=np.uint32)
            triangles.append(np.column_stack([ends, numbers]))
            source.append(self.cut)
        count = sum(map(len, source))
        out.triangles[:count] = np.concatenate(triangles)
        out.source[:count] = np.concatenate(source)
        return self.vertex_capacity, count

    def origins(self) -> refine.Origins:
        """The origins of wedges, followed by those of middles."""
        corners = self.connectivity.faces[self.cut]
        return super().origins().followed_by(corners, np.full(corners.shape, 1 / 3))


@pytest.mark.parametrize("name", meshes.NAMED_MESHES)
def test_named_meshes(name):
    """On every test mesh, the subclass gives a refinement that passes the checker."""
    mesh = meshes.NAMED_MESHES[name]()
    deformed = meshes.wrinkled(mesh, 3)
    refiner = Middles(mesh.faces, mesh.vertices, raised=0.1)
    sound_frame(refiner, deformed)
    assert isinstance(refiner, refine.Refiner)
    assert not refiner.splits.any()


def test_seams_and_attributes():
    """Both sides of a seam and all attributes are written into a stream lent by the caller."""
    tube = meshes.tube(8, 5)
    colours = np.random.default_rng(1).random((len(tube.vertices), 3))
    refiner = Middles(
        tube.faces, tube.vertices, uv=tube.uv, face_uv=tube.face_uv, attributes={"colour": colours}
    )
    assert refiner.vertex_columns == 6 + 2 + 3
    lent = stream_for(refiner, spare=3)
    mesh = refiner.refine(tube.vertices, out=lent)
    refine.check(refiner, mesh, tube.vertices)
    assert np.shares_memory(mesh.positions, lent.vertices)
    origins = refiner.origins()
    expected = (colours[origins.vertices] * origins.weights[..., None]).sum(axis=1)
    assert_allclose(mesh.attributes["colour"], expected, atol=1e-6)
    middles = mesh.uv[len(refiner.connectivity.wedge_vertices) :]
    assert_allclose(middles, tube.uv[tube.face_uv].mean(axis=1), atol=1e-6)


def test_base_refiner_fills_nothing():
    """The base class alone is abstract, and its error names the methods a subclass needs."""
    mesh = meshes.octahedron()
    with pytest.raises(TypeError, match=r"abstract methods '?fill'?, '?triangle"):
        refine.BaseRefiner(mesh.faces, mesh.vertices)
