"""What sections 3 and 4 of the paper promise of a refined mesh, counted.

Face and plane play their own scripts, and the paper's refiner is held to its words in moments of
both. A broken promise is counted, so that 0 is what is hoped for, and the number tells how bad it
is.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from risorius import assets, refine
from risorius.app.performances import script_for
from risorius.app.scenes import FaceScene, PlaneScene, Scene
from risorius.refine.kahler.coherence import sequence_tables
from risorius.refine.kahler.table import CONFIGURATIONS

from ..quality import Everywhere
from .experiments import Measured, Outcome
from .table1 import papers_refiner

Points = npt.NDArray[np.float64]

FRAMES_PER_SECOND = 60
EVERY = 60  # frames from one moment that is looked at to the next
TURN, SHIFT = np.radians(70.0), (200.0, -50.0, 400.0)  # of the motion that bends nothing, in mm


def overview() -> Outcome:
    """Section 3: one pass, the mesh itself unchanged, nothing kept, no points inside triangles."""
    splits = changed = remembered = inside = unsplit = 0
    for scene in (FaceScene(), PlaneScene()):
        refiner = papers_refiner(scene)
        for positions in _moments(scene):
            before = [array.tobytes() for array in (positions, scene.faces)]
            mesh = refiner.refine(positions)
            changed += before != [array.tobytes() for array in (positions, scene.faces)]
            splits = max(splits, int(refiner.splits.max()))
            remembered += _differ(mesh, papers_refiner(scene).refine(positions))
            inside += int((refiner.origins().weights > 0.0).all(axis=1).sum())
            unsplit += _unsplit_that_differ(scene, refiner, mesh)
    return Outcome(
        {
            "most splits of an edge": splits,
            "frames that changed the mesh": changed,
            "frames that remember others": remembered,
            "points inside triangles": inside,
            "unsplit triangles that differ": unsplit,
        }
    )


def criterion() -> Outcome:
    """Section 4.1: nothing is split without bending."""
    values: dict[str, Measured | float] = {}
    for title, move in (("at rest", np.asarray), ("turned and shifted", _moved)):
        values[f"edges split {title}"] = sum(
            int((_after(papers_refiner(scene), move(scene.rest_positions)).splits > 0).sum())
            for scene in (FaceScene(), PlaneScene())
        )
    return Outcome(values)


def smoothing() -> Outcome:
    """Section 4.2: local, close to Loop, and the same on both sides of an edge."""
    moved = 0
    for scene in (FaceScene(), PlaneScene()):
        refiner = papers_refiner(scene)
        for positions in _moments(scene):
            mesh = refiner.refine(positions)
            count = len(positions)
            still = np.ones(count, bool)
            still[refiner.edges[refiner.splits > 0]] = False
            kept = mesh.positions[:count][still] == positions.astype(np.float32)[still]
            moved += int((~kept.all(axis=1)).sum())
    head = assets.load("head")
    ours = refine.create("kahler", head.faces, head.vertices, criterion=Everywhere(1))
    loop = refine.create("loop", head.faces, head.vertices, levels=1)
    off, _ = cKDTree(loop.refine(head.vertices).positions).query(
        ours.refine(head.vertices).positions
    )
    return Outcome({"vertices moved without a split": moved, "off Loop [mm]": float(off.max())})


def table() -> Outcome:
    """Section 4.3: the 27 configurations, and meshes without cracks."""
    cracks, most = 0, 0
    for scene in (FaceScene(), PlaneScene()):
        refiner = papers_refiner(scene)
        for positions in _moments(scene):
            mesh = refiner.refine(positions)
            most = max(most, int(np.bincount(mesh.source).max()))
            try:
                refine.check(refiner, mesh, positions)
            except refine.BrokenMeshError:
                cracks += 1
    return Outcome(
        {
            "entries of the table": len(CONFIGURATIONS.counts),
            "longest entry": int(CONFIGURATIONS.counts.max()),
            "most subtriangles seen": most,
            "frames with cracks": cracks,
        }
    )


def attributes() -> Outcome:
    """Section 4.4: what new points inherit, and the sequences of splits."""
    scene = FaceScene()
    refiner = refine.create("kahler", scene.faces, scene.rest_positions, scene.uv, scene.face_uv)
    bent = 0.0
    for positions in _moments(scene):
        mesh = refiner.refine(positions)
        assert mesh.uv is not None
        bent = max(bent, _off_linear(refiner, mesh.uv))
    lengths = [len(sequence) for sequence in sequence_tables().sequences]
    return Outcome(
        {
            "texture coordinates off linear": bent,
            "sequences": len(lengths),
            "shortest sequence": min(lengths),
            "longest sequence": max(lengths),
        }
    )


def _moments(scene: Scene) -> Iterator[Points]:
    """Positions in moments of the scene's own script."""
    script = script_for(None, scene.name)
    scene.reset()
    for number in range(round(script.duration * FRAMES_PER_SECOND) + 1):
        scene.pose(script.at(number / FRAMES_PER_SECOND))
        scene.step(1.0 / FRAMES_PER_SECOND)
        if number % EVERY == EVERY // 2:
            yield scene.positions.copy()


def _after(refiner: refine.Refiner, positions: Points) -> refine.Refiner:
    refiner.refine(positions)
    return refiner


def _moved(positions: Points) -> Points:
    """The same body elsewhere."""
    cosine, sine = np.cos(TURN), np.sin(TURN)
    turn = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    return np.asarray(positions @ turn.T + SHIFT)


def _differ(one: refine.RefinedMesh, other: refine.RefinedMesh) -> bool:
    """Whether two frames differ in a single bit."""
    return any(a.tobytes() != b.tobytes() for a, b in zip(one[:4], other[:4], strict=True))


def _unsplit_that_differ(scene: Scene, refiner: refine.Refiner, mesh: refine.RefinedMesh) -> int:
    """Triangles without a split that come out otherwise than they went in."""
    is_split = np.asarray((refiner.splits[refiner.triangle_edges] > 0).any(axis=1))
    rows = np.flatnonzero(~is_split[mesh.source])
    corners, before = mesh.triangles[rows], scene.faces[mesh.source[rows]]
    differ = np.not_equal(corners, before).any(axis=1)
    return int(differ.sum()) + abs(len(rows) - int((~is_split).sum()))


def _off_linear(refiner: refine.Refiner, uv: npt.NDArray[np.float32]) -> float:
    """How far texture coordinates of new points are from the line between ends of their edge.

    Each end may have several, one for each side of a seam: the nearest pair counts.
    """
    origins = refiner.origins()
    by_vertex: dict[int, list[npt.NDArray[np.float32]]] = {}
    is_new = origins.weights[:, 0] < 1.0
    for row in np.flatnonzero(~is_new):
        by_vertex.setdefault(int(origins.vertices[row, 0]), []).append(uv[row])
    worst = 0.0
    for row in np.flatnonzero(is_new):
        (a, b, _), (at_a, at_b, _) = origins.vertices[row], origins.weights[row]
        mixes = [at_a * p + at_b * q for p in by_vertex[int(a)] for q in by_vertex[int(b)]]
        worst = max(worst, min(float(np.abs(mix - uv[row]).max()) for mix in mixes))
    return worst
