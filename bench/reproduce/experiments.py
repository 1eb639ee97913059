"""What `risorius reproduce` repeats: one table of experiments, in the order of the paper.

Each is a function of this package that returns an `Outcome`, or the picture alone, and the claims
that it is held to. An entry here is a command, a section of the page and a part of the figures for
programs: nothing else has to be told of a new one.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from .claims import Claim, Finding, Measured, Outcome, Verdict

if TYPE_CHECKING:
    from risorius.app.files import Image

C_RT = {
    "all of it, 1280x720": "c_rt, time per triangle, refined over static: at most the paper's",
    "all of it, 64x36": "the same where pixels cost next to nothing",
    "without drawing": "the same for refining and uploading",
    "refinement alone": "the same for refining alone, against handing through",
}
AS_EXPECTED = (Verdict.MET, Verdict.DIFFERS)
PROMISED = 20.0  # frames a second, of software OpenGL on two cores


@dataclass(frozen=True)
class Experiment:
    """One thing that the paper says, and how it is tried."""

    name: str
    """Of the command, and of its picture."""
    title: str
    place: str
    """Where in the paper it stands."""
    about: str
    """What the command does, in one sentence."""
    function: str
    """MODULE.FUNCTION in this package, imported when it runs."""
    claims: tuple[Claim, ...] = ()
    has_picture: bool = False
    rounds: int | None = None
    """How often it is timed unless told; None where nothing is."""

    @property
    def callable(self) -> Callable[..., Outcome | Image]:
        """The function, imported now."""
        module, _, name = self.function.partition(".")
        function: Callable[..., Outcome | Image]
        function = getattr(importlib.import_module(f"{__package__}.{module}"), name)
        return function

    def run(self, *, rounds: int | None = None) -> Result:
        """Do it."""
        timing = {} if self.rounds is None else {"rounds": rounds or self.rounds}
        made = self.callable(**timing)
        outcome = made if isinstance(made, Outcome) else Outcome(pictures={self.name: made})
        return Result(self, outcome)


@dataclass(frozen=True)
class Result:
    """An experiment that was made."""

    experiment: Experiment
    outcome: Outcome

    @property
    def findings(self) -> list[Finding]:
        """Each claim beside what was measured; KeyError for a claim that was not."""
        return [Finding(claim, _measured(self.outcome, claim)) for claim in self.experiment.claims]

    @property
    def missed(self) -> list[Finding]:
        """Those that are not met."""
        return [each for each in self.findings if each.verdict not in AS_EXPECTED]


def _measured(outcome: Outcome, claim: Claim) -> Measured:
    value = outcome.values[claim.value]
    return value if isinstance(value, Measured) else Measured(float(value))


def _exactly(value: str, number: float, statement: str, expected: str | None = None) -> Claim:
    text = f"{number:g}" if expected is None else expected
    return Claim(value, statement, text, number, number)


def _never(value: str, statement: str) -> Claim:
    return _exactly(value, 0.0, statement, "none")


def _ratios(scene: str, expected: float) -> tuple[Claim, ...]:
    return tuple(
        Claim(f"{scene}, {way}", statement, f"{expected:g}", high=expected, style=".2f")
        for way, statement in C_RT.items()
    )


EXPERIMENTS = (
    Experiment(
        "overview",
        "A refined mesh for the renderer alone",
        "sections 1 and 3",
        "Count what the overview of the method rules out.",
        "statements.overview",
        (
            _exactly("most splits of an edge", 2, "up to two refinements in one step"),
            _never("frames that changed the mesh", "the input mesh remains unaltered"),
            _never("frames that remember others", "nothing of the splits is kept between frames"),
            _never("points inside triangles", "no new vertices inside an original triangle"),
            _never("unsplit triangles that differ", "unsplit triangles are drawn as they are"),
        ),
    ),
    Experiment(
        "criterion",
        "Splitting criterion",
        "section 4.1",
        "Count edges that are split although nothing bends.",
        "statements.criterion",
        (
            _never("edges split at rest", "an undeformed mesh is good enough"),
            _never("edges split turned and shifted", "so is one that moved as a whole"),
        ),
    ),
    Experiment(
        "smoothing",
        "Vertex smoothing",
        "section 4.2",
        "Compare smoothing with Loop's, and count vertices that move without need.",
        "statements.smoothing",
        (
            _never(
                "vertices moved without a split",
                "the surface changes locally only: other vertices stay, to the last bit",
            ),
            Claim(
                "off Loop [mm]",
                "where every edge of the head is split once, it is one step of Loop subdivision",
                "0",
                high=1e-4,
            ),
        ),
    ),
    Experiment(
        "table",
        "Generating subtriangles",
        "section 4.3",
        "Count the configurations, their subtriangles, and cracks.",
        "statements.table",
        (
            _exactly("entries of the table", 27, "the table has one entry for each configuration"),
            _exactly("longest entry", 10, "a triangle becomes ten subtriangles at most"),
            Claim("most subtriangles seen", "the same in both animations", "10", high=10.0),
            _never("frames with cracks", "no cracks appear between neighbours"),
        ),
    ),
    Experiment(
        "sequences",
        "Interpolation, and sequences of splits",
        "section 4.4",
        "Count the sequences of splits, and compare texture coordinates with linear ones.",
        "statements.attributes",
        (
            Claim(
                "texture coordinates off linear",
                "texture coordinates are linear along the edge, on both sides of a seam",
                "0",
                high=1e-6,
            ),
            _exactly("sequences", 271, "all sequences of splits of a triangle"),
            _exactly("shortest sequence", 0, "from the one without a split"),
            _exactly("longest sequence", 6, "to those of two splits on each edge"),
        ),
    ),
    Experiment(
        "coherence",
        "Time-coherent splitting",
        "section 4.4",
        "Draw a film strip of a growing wave, with and without memory of the splits.",
        "figure_coherence.coherence",
        (
            Claim(
                "lines turned without memory",
                "looked up by the splits alone, a split may turn what was there",
                "some",
                low=1,
            ),
            _never("lines turned with memory", "a new split refines the pattern that was there"),
        ),
        has_picture=True,
    ),
    Experiment(
        "figure8",
        "Long, thin triangles along folds",
        "section 5, Figure 8",
        "Draw folds of cloth and skin, and the triangles along them.",
        "figure_claims.figure_8_outcome",
        (
            Claim(
                "cloth: degrees off the fold, refined",
                "subtriangles are aligned to the direction of minimum curvature; 45 is chance",
                "aligned",
                high=32.0,
                style=".0f",
            ),
            Claim(
                "face: degrees off the fold, refined", "the same", "aligned", high=32.0, style=".0f"
            ),
            Claim(
                "cloth: degrees nearer to the fold than before",
                "it is refinement that does it",
                "",
                low=5.0,
                style=".0f",
            ),
            Claim(
                "face: degrees nearer to the fold than before", "the same", "", low=5.0, style=".0f"
            ),
            Claim(
                "cloth: smallest angle, refined over static",
                "many are long and thin",
                "",
                high=0.9,
                style=".2f",
            ),
            Claim(
                "face: smallest angle, refined over static", "the same", "", high=0.9, style=".2f"
            ),
        ),
        has_picture=True,
    ),
    Experiment(
        "figure9",
        "A plane under a strong sine",
        "section 5, Figure 9",
        "Draw the plane: static and refined, flat and Gouraud shaded.",
        "figure_claims.figure_9_outcome",
        (
            Claim(
                "flat: shading error, refined over static",
                "ridges are smoothed out in the curved areas: nearer to the sine itself",
                "less",
                high=0.9,
                style=".2f",
            ),
            Claim(
                "Gouraud: shading error, refined over static",
                "less shading artifacts in the Gouraud shaded model; interpolated normals, as in "
                "the paper, leave it as it is",
                "less",
                low=0.9,
                high=1.1,
                style=".2f",
                is_met=False,
            ),
            Claim(
                "Gouraud: with normals of the refined surface, over static",
                "the same, with the option normals=refined",
                "less",
                high=0.9,
                style=".2f",
            ),
        ),
        has_picture=True,
    ),
    Experiment(
        "figure10",
        "The region of the mouth",
        "section 5, Figure 10",
        "Draw the region of the mouth: static and refined, beside a dense mesh.",
        "figure_claims.figure_10_outcome",
        (
            Claim(
                "pixels that change visibly [%]",
                "the rendered mesh is visibly smoothed (by cubic)",
                "visible",
                low=0.9,
                style=".1f",
            ),
            Claim(
                "difference from the dense mesh, refined over static",
                "less shading artifacts (by cubic)",
                "less",
                high=0.95,
                style=".2f",
            ),
            Claim(
                "wrong pixels of the opening, refined over static",
                "a better silhouette of the opened mouth (by cubic)",
                "less",
                high=0.9,
                style=".2f",
            ),
        ),
        has_picture=True,
    ),
    Experiment(
        "frame-rate",
        "Frame rate of the animation",
        "section 5, Figure 10",
        "Compare the frame rates of the face, simulated and drawn, static and refined.",
        "frame_rate.experiment",
        (
            Claim(
                "frames a second, static",
                f"the authors' graphics card drew 60; {PROMISED:g} are asked of software OpenGL",
                "about 60",
                low=PROMISED,
                style=".1f",
            ),
            Claim(
                "frames a second, refined",
                "the same with refinement",
                "about 60",
                low=PROMISED,
                style=".1f",
            ),
            Claim(
                "frames lost to refinement [%]",
                "the frame rate does not differ noticeably",
                "not noticeable",
                high=10.0,
                style=".1f",
            ),
            Claim(
                "frames a second but for drawing, refined",
                "what a graphics card leaves to the processor keeps up with the screen",
                "about 60",
                low=60.0,
                style=".0f",
            ),
            Claim(
                "physics in all but drawing [%]",
                "the load is mainly the physics",
                "most",
                low=50.0,
                style=".0f",
            ),
        ),
        rounds=200,
    ),
    Experiment(
        "table1",
        "Triangles and times",
        "section 5, Table 1",
        "Print Table 1 of the paper beside our own figures.",
        "table1.experiment",
        (
            _exactly("face, static triangles", 2030, "triangles of the static face"),
            Claim(
                "face, most triangles",
                "most triangles of the refined face, within 25 %: head and animation are others",
                "3120",
                low=2340.0,
                high=3900.0,
            ),
            *_ratios("face", 1.75),
            _exactly("plane, static triangles", 154, "triangles of the static plane"),
            Claim(
                "plane, most triangles",
                "most triangles of the refined plane, within 5 %",
                "1328",
                low=1262.0,
                high=1394.0,
            ),
            *_ratios("plane", 2.58),
        ),
        rounds=60,
    ),
)
"""All experiments."""
