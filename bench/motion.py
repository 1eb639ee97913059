"""How well the muscles move skin: simulated against scanned displacement, expression by expression.

Takes a folder with ICT-FaceKit's neutral face and expressions (MIT, USC Institute for Creative
Technologies) as `face.npz`, poses the rig with the matching muscles on that head, 18461 triangles
that bring nothing but 68 landmarks, and compares the displacement fields, weighted by area:

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
        "corrugator_supercilii": 0.75, "procerus": 0.4, "depressor_supercilii": 0.3,
    },
    "eyeBlink": {"orbicularis_oculi_palpebral_upper": 1.0},
    "noseSneer": {
        "levator_labii_superioris_alaeque_nasi": 1.0, "levator_labii_superioris": 0.5,
        "procerus": 0.4, "corrugator_supercilii": 0.6, "orbicularis_oculi_orbital": 0.45,
    },
    "mouthSmile": {
        "zygomaticus_major": 1.0, "zygomaticus_minor": 0.3, "orbicularis_oculi_orbital": 0.3,
        "buccinator": 0.1,
    },
    "mouthFrown": {"depressor_anguli_oris": 0.85, "mentalis": 0.27},
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
    reference = np.load(Path(directory) / "face.npz")
    with RIG.open("rb") as file:
        rig = tomllib.load(file)
    vertices = reference["vertices"].astype(np.float64)
    faces = reference["triangles"].astype(np.int32)
    landmarks = reference["landmarks68"].astype(np.int64)
    head = SimpleNamespace(vertices=vertices, faces=faces, landmarks=landmarks, rig=rig)
    simulation = sim.create(head)
    areas = _vertex_areas(vertices, faces)
    rows = []
    for expression, muscles in POSES.items():
        fields = [reference[name] for name in _fields(expression, reference.files)]
        scanned: Array = np.sum(fields, axis=0, dtype=np.float64)
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
