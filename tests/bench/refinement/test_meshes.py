"""`bench meshes`: whole folders are refined without a crack, and a crack would be seen."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from click.testing import CliRunner

from risorius import refine
from risorius.__main__ import command
from risorius.bench.refinement.meshes import METHODS, NOISE, refined
from tests.bench.refinement.cracks import cracks
from tests.meshes import NAMED, Mesh, double_cone, fan, irregular, tube, wrinkled

FRAMES = len(METHODS) * len(NOISE)
CALM = ("--seed", "1", "--seconds", "600")  # the first may have to compile on a busy machine


def write(path: Path, vertices: npt.ArrayLike, faces: npt.ArrayLike) -> None:
    """Write a mesh as Wavefront OBJ."""
    lines = ["v " + " ".join(map(str, row)) for row in np.asarray(vertices).tolist()]
    lines += ["f " + " ".join(map(str, row)) for row in (np.asarray(faces) + 1).tolist()]
    path.write_text("\n".join(lines))


def test_a_folder_of_meshes(tmp_path: Path) -> None:
    """Sound and broken meshes are refined, what cannot be read is named, nothing cracks."""
    for name in ("with_debris", "three_on_an_edge", "inconsistent_pair"):
        mesh = NAMED[name]()
        write(tmp_path / f"{name}.obj", mesh.vertices, mesh.faces)
    (tmp_path / "below").mkdir()
    write(tmp_path / "below" / "pillow.obj", NAMED["pillow"]().vertices, NAMED["pillow"]().faces)
    (tmp_path / "broken.ply").write_text("no mesh")
    (tmp_path / "words.md").write_text("no mesh either, and not called one")
    result = CliRunner().invoke(command(), ["bench", "meshes", str(tmp_path), *CALM])
    assert result.exit_code == 0, result.output
    assert "broken.ply: left out, is no PLY file" in result.output
    assert "words.md" not in result.output
    assert "5 files: 4 refined, 1 left out, 0 cut short" in result.output
    assert f"{4 * FRAMES} frames, 0 of them broken" in result.output


def test_a_mesh_that_is_too_large_or_not_there(tmp_path: Path) -> None:
    """Larger meshes than asked for are left out; an empty folder is one line."""
    write(tmp_path / "fan.obj", fan().vertices, fan().faces)
    result = CliRunner().invoke(command(), ["bench", "meshes", str(tmp_path), "--most", "3"])
    assert result.exit_code == 0 and "fan.obj: left out, has more than 3 triangles" in result.output
    (tmp_path / "fan.obj").unlink()
    result = CliRunner().invoke(command(), ["bench", "meshes", str(tmp_path)])
    assert result.exit_code == 2 and "holds no file that could be a mesh" in result.stderr


@pytest.mark.parametrize("mesh", [irregular(3), tube(), double_cone(50)], ids=["a", "b", "c"])
def test_no_method_cracks(mesh: Mesh) -> None:
    """Every method in every pose, at a texture seam and at a vertex with many neighbours, too.

    An oracle that shares nothing with the checker agrees.
    """
    seen = []

    def create(name: str, faces: Any, vertices: Any, **options: Any) -> refine.Refiner:
        refiner = refine.create(name, faces, vertices, **options)
        whole = refiner.refine

        def looked_at(positions: Any) -> refine.RefinedMesh:
            frame = whole(positions)
            seen.append(cracks(faces, frame, refiner.origins()))
            return frame

        refiner.refine = looked_at  # type: ignore[method-assign,assignment]
        return refiner

    found = refined(mesh.vertices, mesh.faces, create=create, seconds=600.0)
    assert found == (FRAMES, [], False)
    assert seen == [None] * FRAMES


def _split_once(frame: refine.RefinedMesh, kept: int, count: int) -> int:
    """An input triangle with `count` pieces."""
    pieces = np.bincount(frame.source)
    return int(np.flatnonzero(pieces == count)[kept])


def _whole_again(frame: refine.RefinedMesh, faces: Any) -> refine.RefinedMesh:
    """A triangle with one split edge comes out whole, its neighbour does not: the crack itself."""
    chosen = _split_once(frame, 0, 2)
    kept = frame.source != chosen
    triangles = np.concatenate([frame.triangles[kept], faces[None, chosen].astype(np.uint32)])
    source = np.append(frame.source[kept], np.int32(chosen))
    return frame._replace(triangles=triangles, source=source)


def _without(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A piece is missing."""
    return frame._replace(triangles=frame.triangles[1:], source=frame.source[1:])


def _twice(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A piece is there twice."""
    triangles = np.concatenate([frame.triangles, frame.triangles[:1]])
    return frame._replace(triangles=triangles, source=np.append(frame.source, frame.source[0]))


def _turned(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A piece is turned over."""
    triangles = frame.triangles.copy()
    triangles[0] = triangles[0, ::-1]
    return frame._replace(triangles=triangles)


def _moved(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A copy of a point along a seam is moved by the least there is."""
    positions = frame.positions.copy()
    positions[-1, 0] = np.nextafter(positions[-1, 0], np.float32(9.0))
    return frame._replace(positions=positions)


def _shaded(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """The normal of such a copy is another."""
    normals = frame.normals.copy()
    normals[-1] = -normals[-1]
    return frame._replace(normals=normals)


def _long(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """Normals are not of length one."""
    return frame._replace(normals=frame.normals * np.float32(1.01))


def _nowhere(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A position is no number."""
    positions = frame.positions.copy()
    positions[3, 1] = np.nan
    return frame._replace(positions=positions)


def _elsewhere(frame: refine.RefinedMesh, _: Any) -> refine.RefinedMesh:
    """A piece says that it is part of another triangle."""
    source = frame.source.copy()
    source[0] = source[-1]
    return frame._replace(source=source)


BREAKS: dict[Callable[..., refine.RefinedMesh], str] = {
    _whole_again: "split it differently (crack)",
    _without: "an input triangle is not covered once",
    _twice: "an input triangle is not covered once",
    _turned: "a piece is turned over",
    _moved: "two positions",
    _shaded: "two normals",
    _long: "neither length one nor zero",
    _nowhere: "not finite",
    _elsewhere: "reaches out of its input triangle",
}


@pytest.mark.parametrize("broken", BREAKS, ids=lambda each: each.__name__.strip("_"))
def test_the_checker_sees(broken: Callable[..., refine.RefinedMesh]) -> None:
    """Each way in which a frame can be broken is seen; the oracle calls it by its name."""
    mesh = tube(16, 8)
    refiner = refine.create("kahler", mesh.faces, mesh.vertices, mesh.uv, mesh.face_uv)
    pose = wrinkled(mesh, 7, amplitude=0.1)
    frame = refiner.refine(pose)
    assert cracks(mesh.faces, frame, refiner.origins()) is None
    refine.check(refiner, frame, pose)
    with pytest.raises(refine.BrokenMeshError):
        refine.check(refiner, broken(frame, mesh.faces), pose)
    words = cracks(mesh.faces, broken(frame, mesh.faces), refiner.origins())
    assert words is not None and BREAKS[broken] in words


class Meddler(refine.PassThrough):
    """A refiner that writes into the mesh it is lent."""

    def refine(self, positions: Any, out: Any = None, view: Any = None) -> refine.RefinedMesh:
        frame = super().refine(positions, out, view)
        positions[0, 0] += 1.0
        return frame


def test_a_broken_refiner_is_told(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A crack ends the command with exit code 1, and a line names the edge."""
    mesh = irregular(3)  # large enough that every pose splits one edge of some triangle
    whole = refine.Kahler.refine

    def cracked(self: refine.Kahler, *arguments: Any) -> refine.RefinedMesh:
        frame = whole(self, *arguments)
        is_split = (np.bincount(frame.source) == 2).any()
        return _whole_again(frame, mesh.faces) if is_split else frame

    monkeypatch.setattr(refine.Kahler, "refine", cracked)
    write(tmp_path / "grid.obj", mesh.vertices, mesh.faces)
    result = CliRunner().invoke(command(), ["bench", "meshes", str(tmp_path), *CALM])
    assert result.exit_code == 1, result.output
    assert ": a sub-edge on an input edge has the same sides" in result.output


def test_a_meddling_refiner_is_told() -> None:
    """Whoever changes the pose that is lent is found out."""
    mesh = fan()

    def create(_: str, *arguments: Any, **__: Any) -> Meddler:
        return Meddler(*arguments)

    _, broken, _ = refined(mesh.vertices, mesh.faces, create=create, seconds=600.0)
    assert len(broken) == FRAMES and "the mesh that was lent has changed" in broken[0]


def test_a_triangle_that_names_a_vertex_twice_comes_out_once() -> None:
    """Left out, or there twice, it is told."""
    mesh = NAMED["with_debris"]()
    refiner = refine.create("none", mesh.faces, mesh.vertices)
    frame = refiner.refine(mesh.vertices)
    kept = frame.source != np.flatnonzero((mesh.faces == 2).all(axis=1))[0]
    less = refine.RefinedMesh(
        frame.positions, frame.normals, frame.triangles[kept], frame.source[kept], None,
        MappingProxyType({}),
    )  # fmt: skip
    assert cracks(mesh.faces, frame, refiner.origins()) is None
    assert "does not come out once" in str(cracks(mesh.faces, less, refiner.origins()))


class Confused(refine.PassThrough):
    """A refiner that takes the first edge of the mesh for two."""

    @property
    def edges(self) -> npt.NDArray[np.int32]:
        whole = super().edges
        return np.concatenate([whole, whole[:1]])


def test_a_refiner_that_confuses_edges_is_told() -> None:
    """Two edges where the mesh has one would make a crack that the checker takes for a border."""
    mesh = fan()

    def create(_: str, *arguments: Any, **__: Any) -> Confused:
        return Confused(*arguments)

    _, broken, _ = refined(mesh.vertices, mesh.faces, create=create, seconds=600.0)
    assert len(broken) == FRAMES and "edges of the refiner are not those of the mesh" in broken[0]
