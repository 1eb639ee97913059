"""What a face tracker sees in our faces: every shape of ARKit at 1, read back from pictures.

A shape is right if somebody else's eyes call it by its name. Each is drawn from VIEWS and shown to
the tracker as it is and mirrored, so that its own left and right do not count. Told is how far the
mean score is above that of the neutral face:

    own      of the shape itself; of a pair, both sides of which are posed, the mean of both
    highest  the other shape that scores most, with its score; of pairs the mean of both sides
    left, right    own score of one side that is posed alone. Head and muscles are the same on both
             sides, so where these differ, the light does it, which falls from the subject's right

A tracker is no measure of anatomy: it learned what comes together in real faces, and some shapes it
never answers. So scans of real faces may stand beside ours, on their own head, drawn and read in
the same way: what they do not score either, no face of ours has to.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import astuple, dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius.app.capture import Capture, CaptureOptions
from risorius.app.capture.cameras import camera_for
from risorius.app.controls.mirror import parted, twin_of
from risorius.app.errors import UserError
from risorius.app.files import save_png
from risorius.app.motion import SETTLING
from risorius.app.recordings.names import ARKIT
from risorius.app.scenes import FaceScene, Scene
from risorius.assets.fitting import FittedHead

from .face_tracker import FaceTracker, Scores, in_mirror, mean_of
from .motion import read_scans
from .report import table

VIEWS = ("front", "-8,0", "8,0")  # as people sit before a camera
SIZE = (560, 560)  # pixels; the tracker looks at 256 x 256 of the face
SEEN = 0.1  # a score below says nothing
# Sides that cannot be posed together: they are one shape to either side.
TO_ONE_SIDE = ("mouthLeft, Right", "jawLeft, Right", "eyeLookIn", "eyeLookOut")
# No eye looks to the side alone.
TOGETHER = {
    "eyeLookInLeft": ("eyeLookOutRight",),
    "eyeLookInRight": ("eyeLookOutLeft",),
    "eyeLookOutLeft": ("eyeLookInRight",),
    "eyeLookOutRight": ("eyeLookInLeft",),
}


@dataclass(frozen=True)
class Shape:
    """What the tracker sees in one shape, or pair of shapes; see the module."""

    name: str
    own: float
    highest: str
    score: float
    verdict: str
    left: float | None = None
    right: float | None = None


@dataclass(frozen=True)
class Report:
    """All shapes, those of scans where there are some, and how far the tracker can be trusted."""

    shapes: Sequence[Shape]
    scanned: Mapping[str, Shape]
    neutral: Scores
    repeated: float  # how far two readings of the same pictures differ at most
    sides: float  # how far mirror images differ in their greatest score, in the median


def verdict(own: float, highest: str, score: float) -> str:
    """Whether a shape is seen, and under which name."""
    if max(own, score) < SEEN:
        return "not seen"
    return "seen" if own >= score else f"as {highest}"


class Sitting:
    """A scene before the tracker; a context manager."""

    def __init__(self, tracker: FaceTracker, scene: Scene, pictures: Path | None = None) -> None:
        """pictures: a folder for all that the tracker is shown."""
        self.scene = scene
        self.sides: list[tuple[Scores, Scores]] = []
        self._tracker, self._pictures = tracker, pictures
        self._capture = Capture(scene, CaptureOptions(size=SIZE))

    def __enter__(self) -> Sitting:
        return self

    def __exit__(self, *_: object) -> None:
        self._capture.surface.close()

    def pose(self, name: str, controls: Sequence[str]) -> Scores:
        """Scores with some controls at 1."""
        self.scene.reset()
        self.scene.pose(dict.fromkeys(controls, 1.0))
        self.scene.step(SETTLING)
        return self.look(name)

    def look(self, name: str) -> Scores:
        """Scores of the scene as it is: mean over VIEWS and their mirror images."""
        straight, mirrored = [], []
        for number, view in enumerate(VIEWS, start=1):
            self._capture.camera = camera_for(self.scene, view)
            image = self._capture.draw_image()
            if self._pictures is not None:
                save_png(self._pictures / f"{name}_{number}.png", image)
            straight.append(self._tracker.scores(image))
            mirrored.append(in_mirror(self._tracker.scores(image[:, ::-1])))
        both = mean_of(straight), mean_of(mirrored)
        if not all(both):
            raise UserError(f"the tracker finds no face in the pictures of '{name}'")
        self.sides.append(both)
        return mean_of(both)


def bases() -> Iterator[tuple[str, tuple[str, ...]]]:
    """Every shape of ARKit: its name without side, and its names with them."""
    for name in ARKIT:
        stem, side = parted(name)
        if not side:
            yield name, (name,)
        elif side == "Left":
            yield stem if stem not in ("jaw", "mouth") else f"{name}, Right", (name, twin_of(name))


def compared(
    scores: Scores, neutral: Scores, own: Sequence[str], posed: Sequence[str] = ()
) -> tuple[float, str, float]:
    """Own score over the neutral face, mean of `own`; the other shape that scores most; its score.

    posed: shapes that are there besides, and no mistake. Sides count by their mean, beside a side
    that was posed alone by the greater one.
    """
    is_sided = len(own) == 1 and twin_of(own[0]) != own[0]
    over = {name: scores[name] - neutral[name] for name in scores if name in ARKIT}
    others: dict[str, float] = {}
    for base, sides in bases():
        found = [over[side] for side in sides if side in over]
        if found and not {*sides} & {*own, *posed}:
            others[base] = max(found) if is_sided else float(np.mean(found))
    highest = max(others, key=lambda name: others[name])
    return float(np.mean([over.get(name, 0.0) for name in own])), highest, others[highest]


def measure(
    tracker: FaceTracker, pictures: Path | None = None, reference: Path | None = None
) -> Report:
    """Show every shape of the built-in head to the tracker.

    pictures: a folder for all that it is shown. reference: a folder of scans, see motion.py;
    raises ValueError, naming the file, if that is broken.
    """
    scanned = {} if reference is None else _scanned(tracker, reference, pictures)
    with Sitting(tracker, FaceScene(), pictures) as sitting:
        neutral = sitting.pose("neutral", ())
        repeated = sitting.pose("neutral", ())
        shapes = [_shape(sitting, name, names, neutral) for name, names in bases()]
        sides = [_apart(*pair) for pair in sitting.sides]
    differences = [abs(repeated[name] - neutral[name]) for name in neutral]
    return Report(shapes, scanned, neutral, max(differences), float(np.median(sides)))


def _apart(straight: Scores, mirrored: Scores) -> float:
    """How far the greatest score of a picture is from that of its mirror image."""
    name = max(straight, key=lambda name: straight[name])
    return abs(straight[name] - mirrored[name])


def _shape(sitting: Sitting, name: str, names: tuple[str, ...], neutral: Scores) -> Shape:
    """Pose a shape, or a pair of shapes together and each of them alone."""
    if len(names) == 1:
        return _as_seen(name, compared(sitting.pose(name, names), neutral, names))
    alone = []
    for side in names:
        posed = (side, *TOGETHER.get(side, ()))
        alone.append(compared(sitting.pose(side, posed), neutral, (side,), posed))
    (left, *_), (right, *_) = alone
    if name in TO_ONE_SIDE:
        whole = (left + right) / 2.0, *max(alone, key=lambda each: each[2])[1:]
    else:
        whole = compared(sitting.pose(name, names), neutral, names)
    return _as_seen(name, whole, left, right)


def _as_seen(
    name: str,
    whole: tuple[float, str, float],
    left: float | None = None,
    right: float | None = None,
) -> Shape:
    return Shape(name, *whole, verdict(*whole), left, right)


class ScannedScene(FaceScene):
    """A head in the shape of a scan; muscles do nothing."""

    def __init__(self, head: FittedHead) -> None:
        super().__init__(head)
        self.shown = self.rest_positions

    @property
    def positions(self) -> npt.NDArray[np.float64]:
        return self.shown


def _scanned(tracker: FaceTracker, reference: Path, pictures: Path | None) -> dict[str, Shape]:
    """What the tracker sees in scans: name of the shape, without side -> what it sees."""
    scans = read_scans(reference)
    by_name = {_arkit_name(name): name for name in scans.names}
    with Sitting(tracker, ScannedScene(scans.head), pictures) as sitting:
        scene = sitting.scene
        assert isinstance(scene, ScannedScene)
        neutral = sitting.look("scan_neutral")
        found = {}
        for name, names in bases():
            stem = names[0].removesuffix("Left")
            ways = (stem, f"{stem}Left", f"{stem}Right")  # with sides, too, where ARKit has none
            parts = [by_name[each] for each in ways if each in by_name]
            own = tuple(each for each in names if each in by_name)
            if not parts:
                continue
            if name in TO_ONE_SIDE:
                parts, own = parts[:1], own[:1]
            moved = np.sum([scans.field(part) for part in parts], axis=0)
            scene.shown = scene.rest_positions + moved
            seen = sitting.look(f"scan_{name}")
            found[name] = _as_seen(name, compared(seen, neutral, own or names))
    return found


def _arkit_name(field: str) -> str:
    """The name of a field of scans in ARKit's spelling: mouthSmile_L is mouthSmileLeft."""
    for ending, side in (("_L", "Left"), ("_R", "Right")):
        if field.endswith(ending):
            return field.removesuffix(ending) + side
    return field


def report(found: Report) -> str:
    """The text to print."""
    columns = "shape:<17|own:6.2f| highest:<19|score:6.2f| verdict:<22|left:6.2f|right:6.2f"
    if found.scanned:
        columns += "|scan own:9.2f| highest:<19|score:6.2f"
    rows = []
    for shape in found.shapes:
        row = [*astuple(shape)]
        row[2], row[4] = f" {row[2]}", f" {row[4]}"
        scan = found.scanned.get(shape.name)
        if found.scanned:
            row += [None] * 3 if scan is None else [scan.own, f" {scan.highest}", scan.score]
        rows.append(row)
    neutral = sorted(found.neutral.items(), key=lambda item: -item[1])
    told = ", ".join(f"{name} {score:.2f}" for name, score in neutral if score >= SEEN)
    own = sum(shape.verdict == "seen" for shape in found.shapes)
    return "\n".join(
        [
            "Every shape at 1 on the built-in head, as a face tracker scores it over the neutral",
            f"face: mean of {len(VIEWS)} views and their mirror images. Pairs are posed together,",
            "left and right alone.",
            "",
            *table(columns, rows, empty="-"),
            "",
            f"{own} of {len(found.shapes)} score highest under their own name",
            f"neutral face: {told}",
            f"the same pictures once more: scores differ by {found.repeated:.3f} at most",
            f"a picture and its mirror image: the greatest score differs by {found.sides:.3f} "
            "in the median",
        ]
    )
