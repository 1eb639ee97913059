"""How long a 60 Hz frame of the simulation takes: the built-in head, and plain meshes of any size.

The head is timed with every muscle at work, each at a new strength in every frame, so that nothing
is ever settled; at rest, for comparison; and plain square meshes, without muscles, while they
swing after a blow. `sim.create` is not counted.

Before each timed frame the same simulation does one that is not timed: in use, a frame follows a
frame, and does not find its data driven from the processor's cache by another mesh.

All are run interleaved, forwards and backwards in turn, with garbage collection off, and medians
are reported: on a shared machine times drift by a third within a run, and so only rows of one run
can be compared. The best time is reported beside the median for the same reason: it is what a free
core does.
"""

from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass
from functools import partial
from types import SimpleNamespace

import numpy as np

from risorius import assets, sim

from ..report import processor, table
from ..timing import interleaved

FRAME = 1.0 / 60.0
SIZES = (1_000, 10_000, 100_000)  # vertices of the plain meshes
MILLIMETRES = 250.0  # edge length of the plain meshes: a head's size
BLOW = 200.0  # mm/s
SEED = 2003


@dataclass(frozen=True)
class Row:
    """One mesh in one motion."""

    motion: str
    """What is simulated."""
    vertices: int
    """Vertices of the mesh."""
    triangles: int
    """Triangles of the mesh."""
    milliseconds: float
    """Time of a frame, median over the rounds [ms]."""
    best_milliseconds: float
    """Time of a frame, shortest of all rounds [ms]."""

    @property
    def nanoseconds_per_vertex(self) -> float:
        """Median time per vertex and frame [ns]."""
        return 1e6 * self.milliseconds / self.vertices


@dataclass(frozen=True)
class _Subject:
    """A simulation and what is done to it before each timed frame."""

    motion: str
    simulation: sim.Simulation
    prepare: Callable[[], None]

    def after_a_frame(self) -> None:
        """One frame that is not timed, then ready for the next."""
        self.prepare()
        self.simulation.step(FRAME)
        self.prepare()


def measure(*, rounds: int = 200, sizes: Sequence[int] = SIZES) -> list[Row]:
    """Time one frame of each subject in each of `rounds` rounds and return one row for each.

    `sizes`: about how many vertices the plain meshes have. Raises ValueError without rounds.
    """
    if rounds < 1:
        raise ValueError(f"rounds: was {rounds}, must be at least 1")
    generator = np.random.default_rng(SEED)
    subjects = [
        _head_at_work(generator),
        _Subject("head, at rest", sim.create(assets.load("head")), lambda: None),
        *(_plain(size, generator) for size in sizes),
    ]
    for subject in subjects:  # compiles or loads the kernels
        subject.prepare()
        subject.simulation.step(FRAME)
    seconds = interleaved(
        [partial(subject.simulation.step, FRAME) for subject in subjects],
        rounds,
        prepare=[subject.after_a_frame for subject in subjects],
    )
    return [
        Row(
            motion=subject.motion,
            vertices=len(subject.simulation.positions),
            triangles=len(subject.simulation.faces),
            milliseconds=1e3 * float(np.median(times)),
            best_milliseconds=1e3 * float(np.min(times)),
        )
        for subject, times in zip(subjects, seconds.T, strict=True)
    ]


def _head_at_work(generator: np.random.Generator) -> _Subject:
    """The built-in head; every control gets a new value, none is zero."""
    simulation = sim.create(assets.load("head"))
    limits = {name: simulation.limits[name] for name in simulation.controls}

    def prepare() -> None:
        strengths = generator.uniform(0.2, 1.0, len(limits))
        simulation.set_all(
            {name: s * high for (name, (_, high)), s in zip(limits.items(), strengths, strict=True)}
        )

    return _Subject("head, all muscles", simulation, prepare)


def _plain(size: int, generator: np.random.Generator) -> _Subject:
    """A square mesh of about `size` vertices that is struck before every frame."""
    side = max(round(size**0.5), 2)
    along = np.linspace(0.0, MILLIMETRES, side)
    x, y = np.meshgrid(along, along)
    vertices = np.stack([x.ravel(), y.ravel(), np.zeros(side * side)], axis=1)
    corner = (np.arange(side - 1)[:, None] * side + np.arange(side - 1)).ravel()
    lower = np.stack([corner, corner + 1, corner + side], axis=1)
    upper = np.stack([corner + 1, corner + side + 1, corner + side], axis=1)
    faces = np.vstack([lower, upper])
    simulation = sim.create(SimpleNamespace(vertices=vertices, faces=faces))
    blow = generator.normal(scale=BLOW, size=vertices.shape)
    return _Subject("plain mesh", simulation, lambda: simulation.kick(blow))


def report(rows: Sequence[Row], rounds: int) -> str:
    """The text to print."""
    columns = "motion:<28|vertices:8d|triangles:9d|ms:8.3f|best:8.3f|ns/vertex:9.0f"
    return "\n".join(
        [
            f"One frame of 1/60 s, serial, one core of {processor()}: medians of {rounds}",
            "interleaved rounds; set up is not counted.",
            "",
            *table(columns, [(*astuple(row), row.nanoseconds_per_vertex) for row in rows]),
        ]
    )
