"""How well the muscles move skin: simulated against scanned displacement, expression by expression.

Takes a folder with ICT-FaceKit's neutral face and expressions (MIT, USC Institute for Creative
Technologies) as `face.npz` and a decimation `coarse_2029.npz`, poses the rig with the matching
muscles and compares the two displacement fields, weighted by area:

    cosine      1 = same directions and proportions          magnitude   |simulated| / |scanned|
    residual    |simulated - scanned|^2 / |scanned|^2        peak        largest simulated [mm]

The rig started from values fitted to these scans, so this is a training score; it guards against
breaking the rig, no more.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import numpy.typing as npt

import sim

Array = npt.NDArray[np.float64]

RIG = Path(__file__).parent.parent / "assets" / "rigs" / "face.toml"
FRAME = 1.0 / 60.0
SETTLE = 90  # frames until a pose is still
MILLIMETRES = 10.0  # per unit of the reference (cm)

# Expression of the reference -> muscles (both sides, or jaw); after FACS, field strengths fitted.
POSES: dict[str, dict[str, float]] = {
    "browInnerUp": {"frontalis_medial": 1.0},
    "browDown": {
        "corrugator_supercilii": 1.0, "procerus": 0.45, "depressor_supercilii": 0.45,
    },
    "eyeBlink": {"orbicularis_oculi_palpebral_upper": 1.0},
    "noseSneer": {
        "levator_labii_superioris_alaeque_nasi": 1.0, "levator_labii_superioris": 0.5,
        "procerus": 0.46, "corrugator_supercilii": 0.9, "orbicularis_oculi_orbital": 0.45,
    },
    "mouthSmile": {
        "zygomaticus_major": 1.0, "zygomaticus_minor": 0.3, "orbicularis_oculi_orbital": 0.3,
        "buccinator": 0.1,
    },
    "mouthFrown": {"depressor_anguli_oris": 1.0, "mentalis": 0.27},
    "mouthStretch": {"risorius": 1.0, "platysma": 1.0, "depressor_anguli_oris": 0.17},
    "mouthLowerDown": {
        "depressor_labii_inferioris": 1.0, "platysma": 0.05, "depressor_anguli_oris": 0.12,
    },
    "mouthPucker": {
        "incisivus_labii_superioris": 1.0, "incisivus_labii_inferioris": 1.0, "mentalis": 0.15,
    },
    "jawOpen": {"jaw_open": 1.0},
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """Scores of one expression."""

    expression: str
    cosine: float
    magnitude: float
    residual: float
    peak: float


def run(directory: str | Path) -> list[Row]:
    """Score every expression of the reference in `directory`; the last row is the mean."""
    fine = np.load(Path(directory) / "face.npz")
    coarse = np.load(Path(directory) / "coarse_2029.npz")
    with RIG.open("rb") as file:
        rig = tomllib.load(file)
    corners = fine["triangles"][coarse["fine_triangle"]]
    barycentric = coarse["barycentric"].astype(np.float64)[:, :, None]

    def on_coarse(field: npt.NDArray[np.floating]) -> Array:
        carried: Array = (field.astype(np.float64)[corners] * barycentric).sum(axis=1)
        return carried

    vertices = on_coarse(fine["vertices"])
    points = fine["vertices"][fine["landmarks68"]]
    landmarks = ((vertices[None] - points[:, None]) ** 2).sum(axis=2).argmin(axis=1)
    faces = coarse["triangles"].astype(np.int32)
    head = SimpleNamespace(vertices=vertices, faces=faces, landmarks=landmarks, rig=rig)
    simulation = sim.create(head)
    areas = _vertex_areas(vertices, faces)
    rows = []
    for expression, muscles in POSES.items():
        names = _fields(expression, fine.files)
        scanned = np.sum([on_coarse(fine[name]) for name in names], axis=0)
        rows.append(_score(expression, _posed(simulation, muscles), scanned, areas))
    means = np.mean([[r.cosine, r.magnitude, r.residual, r.peak] for r in rows], axis=0)
    return [*rows, Row("mean", *(float(m) for m in means))]


def _fields(expression: str, names: list[str]) -> list[str]:
    """Names of the fields of both sides, or of the one in the middle."""
    sides = [f"{expression}_L", f"{expression}_R"]
    return [expression] if expression in names else sides


def _posed(simulation: sim.Simulation, muscles: dict[str, float]) -> Array:
    """Displacement [reference units] of the settled pose, shape (V, 3)."""
    simulation.reset()
    for name, value in muscles.items():
        for control in (name, f"{name}_left", f"{name}_right"):
            if control in simulation.controls:
                simulation.set(control, value)
    for _ in range(SETTLE):
        simulation.step(FRAME)
    moved: Array = simulation.positions - simulation.rest_positions
    return moved


def _score(expression: str, moved: Array, scanned: Array, areas: Array) -> Row:
    """Compare two displacement fields, weighted by area."""

    def product(a: Array, b: Array) -> float:
        return float((areas[:, None] * a * b).sum())

    own, true = product(moved, moved), product(scanned, scanned)
    peak = float(np.linalg.norm(moved, axis=1).max()) * MILLIMETRES
    return Row(
        expression,
        product(moved, scanned) / np.sqrt(own * true),
        np.sqrt(own / true),
        product(moved - scanned, moved - scanned) / true,
        peak,
    )


def _vertex_areas(vertices: Array, faces: npt.NDArray[np.int32]) -> Array:
    """A third of the adjacent triangles' area, shape (V,)."""
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6.0
    areas: Array = np.bincount(faces.ravel(), np.repeat(third, 3), minlength=len(vertices)).astype(
        float
    )
    return areas
