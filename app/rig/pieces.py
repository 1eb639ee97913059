"""Find the pieces of a head's file, which are sets of connected triangles, and their roles.

A piece can be an eyeball, teeth, the tongue, lashes, hair or a body. The skin, on which the
landmarks lie, is not a piece. Shape and position decide the role: eyeballs are round and lie behind
the lids, and pieces in the mouth lie near the fitted built-in teeth and tongue.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
import scipy

from risorius.assets.fitting import FittedHead
from risorius.assets.fitting.eyeballs import is_eyeball
from risorius.geometry.arrays import Floats64, Integers32
from risorius.geometry.mesh_graph import pieces_of

from ..errors import UserError

MOTION_OF_ROLE = {  # role of a piece -> its motion
    "eye_left": "eyeball, turns with the left eye",
    "eye_right": "eyeball, turns with the right eye",
    "upper_teeth": "upper teeth or gums, fixed to the cranium",
    "lower_teeth": "lower teeth or gums, fixed to the mandible",
    "tongue": "tongue, bends",
    "mouth": "inside of the mouth, stretches between both jaws",
    "on_skin": "on the skin and moved by it: lashes, brows, a beard",
    "hair": "hair or a helmet, fixed to the cranium",
    "body": "body or clothes, without motion",
    "hidden": "not drawn; the vertices stay in the file",
}
MOUTH_PART_NAMES = ("teeth", "gums", "tongue")  # beginnings of names of built-in parts
FACE_LANDMARKS = slice(17, 68)  # landmarks without the jaw line
FACE_MARGIN = 12.0  # [mm]; greatest distance of lashes and brows from the box of these landmarks
CHIN_LANDMARK = 8  # landmark
LOWER_LIP_LANDMARK = 57  # landmark below the centre of the lower lip
NOSE_BRIDGE_LANDMARK = 27  # landmark


@dataclass(frozen=True)
class FilePiece:
    """Connected vertices of a file, with a role.

    number: number of the piece in options.
    vertices: vertex indices in the file, (n,).
    role: one of MOTION_OF_ROLE.
    centre: centre of the bounding box [mm], (3,).
    name: name of the object or group in the file, or "".
    """

    number: int
    vertices: npt.NDArray[np.integer]
    role: str
    centre: Floats64
    name: str = ""


def find_pieces(
    rest: Floats64,
    faces: Integers32,
    skin: npt.NDArray[np.integer],
    head: FittedHead,
    names: npt.NDArray[np.object_],
) -> list[FilePiece]:
    """Return the pieces of a file except the skin, in the order of the file.

    rest: all vertices of the file [mm], (V, 3).
    faces: all triangles, (F, 3).
    skin: vertex indices of the skin.
    names: name of the object or group of each vertex, (V,).
    """
    piece = pieces_of(faces, len(rest))
    order = np.argsort(piece, kind="stable")
    starts = np.flatnonzero(np.diff(piece[order], prepend=-1))
    used = np.zeros(len(rest), np.bool_)
    used[faces] = True
    skins = np.unique(piece[skin])
    near = scipy.spatial.cKDTree(head.vertices)
    mouth = _mouth_of(head)
    groups = [
        group
        for group in np.split(order, starts[1:])
        if used[group[0]] and piece[group[0]] not in skins
    ]
    groups.sort(key=lambda group: int(group[0]))
    if mouth is not None:
        mouth = _between_own_rows(mouth, [rest[group] for group in groups])
    found = []
    for number, group in enumerate(groups, start=1):
        points = rest[group]
        centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
        role = _role_of(points, centre, head, mouth, near)
        found.append(FilePiece(number, group, role, centre, names[group[0]]))
    return _correct_teeth(found, rest)


def without_helpers(pieces: Sequence[FilePiece]) -> list[FilePiece]:
    """Hide the auxiliary geometry of MakeHuman's base mesh: joints, blank hair and blank clothes.

    Its eyes, teeth, tongue and lashes stay, because they have their real forms.
    """
    found = []
    for piece in pieces:
        is_helper = piece.name.startswith("helper-") and piece.role in ("hair", "body")
        is_hidden = is_helper or piece.name.startswith(("joint-", "helper-hair"))
        found.append(replace(piece, role="hidden") if is_hidden else piece)
    return found


@dataclass(frozen=True)
class _Mouth:
    """The box around the built-in teeth and tongue [mm].

    low, high: corners of the box, (3,).
    between: height of the gap between both rows of teeth.
    width: width of the teeth and gums.
    """

    low: Floats64
    high: Floats64
    between: float
    width: float


def _mouth_of(head: FittedHead) -> _Mouth | None:
    """Return the mouth of a head; None if it lacks built-in teeth or a tongue."""
    parts = {
        part.name: part.vertices for part in head.parts if part.name.startswith(MOUTH_PART_NAMES)
    }
    if not {"teeth_upper", "teeth_lower", "tongue"} <= set(parts):
        return None
    around = np.vstack([*parts.values()])
    # Roots of teeth reach far up and down, a throat reaches far back, and lips lie in front.
    return _Mouth(
        low=around.min(axis=0) - np.array([6.0, 12.0, 25.0]),
        high=around.max(axis=0) + np.array([6.0, 12.0, 2.0]),
        between=0.5 * (parts["teeth_upper"][:, 1].min() + parts["teeth_lower"][:, 1].max()),
        width=float(np.ptp(around[:, 0])),
    )


def _between_own_rows(mouth: _Mouth, pieces: Sequence[Floats64]) -> _Mouth:
    """Move the gap between the teeth to the middle of the file's two rows, if it has both.

    Lips decide the place of the built-in teeth. Those of a file may lie 10 mm higher or lower.

    pieces: points of all pieces [mm], (n, 3) each.
    """
    heights = []
    for points in pieces:
        low = points.min(axis=0)
        high = points.max(axis=0)
        is_in = ((points > mouth.low) & (points < mouth.high)).all(axis=1).mean() > 0.8
        is_wide = high[0] - low[0] > 0.5 * mouth.width
        if is_in and is_wide and high[1] - low[1] < 35.0 and not _is_filled(points):
            heights.append(0.5 * (low[1] + high[1]))
    least_apart = 6.0  # [mm] between the middles of both rows
    if len(heights) < 2 or max(heights) - min(heights) < least_apart:
        return mouth
    return replace(mouth, between=float(0.5 * (min(heights) + max(heights))))


def _is_filled(points: Floats64) -> bool:
    """Whether a piece is not hollow in its middle; a row of teeth is, a tongue and a palate not."""
    width, _, depth = np.ptp(points, axis=0)
    centre = 0.5 * (points[:, 0].min() + points[:, 0].max())
    is_middle = np.abs(points[:, 0] - centre) < 0.15 * width
    return bool(_extent(points[is_middle, 2]) > 0.6 * depth)


def _role_of(
    points: Floats64,
    centre: Floats64,
    head: FittedHead,
    mouth: _Mouth | None,
    near: scipy.spatial.cKDTree,
) -> str:
    """Return the role of a piece; points: vertices of the piece [mm], (n, 3)."""
    for eye in head.eyes:
        if is_eyeball(points, eye.centre, eye.radius):
            return f"eye_{eye.name}"
    if mouth is not None:
        role = _role_in_mouth(points, centre, mouth)
        if role is not None:
            return role
    landmarks = head.vertices[head.landmarks]
    distance = near.query(points)[0]
    if distance.min() < 4.0 and (
        _is_on_face(points, centre, distance, landmarks) or _is_beard(points, centre, landmarks)
    ):
        return "on_skin"
    # A collar reaches up to the chin; long hair hangs down from above the chin.
    if points[:, 1].max() < landmarks[CHIN_LANDMARK, 1]:
        return "body"
    return "hair"


def _is_on_face(
    points: Floats64, centre: Floats64, distance: Floats64, landmarks: Floats64
) -> bool:
    """Whether a piece is a lash, a brow or similar.

    distance: distances of the points from the skin [mm], (n,). landmarks: [mm], (68, 3).
    """
    face = landmarks[FACE_LANDMARKS]
    low = face.min(axis=0) - FACE_MARGIN
    high = face.max(axis=0) + FACE_MARGIN
    is_on_face = (centre > low) & (centre < high)
    # Glasses span both eyes and hang in front of them.
    is_in_front = np.ptp(points[:, 0]) > 60.0 and np.median(distance) > 5.0
    # Lashes are shorter than 20 mm.
    return bool(is_on_face.all() and distance.max() < 20.0 and not is_in_front)


def _is_beard(points: Floats64, centre: Floats64, landmarks: Floats64) -> bool:
    """Whether a piece lies around mouth or chin, below the eyes and in front of the ears."""
    low = points.min(axis=0)
    high = points.max(axis=0)
    jaw_line = landmarks[:17]
    lip, bridge, chin = landmarks[[LOWER_LIP_LANDMARK, NOSE_BRIDGE_LANDMARK, CHIN_LANDMARK]]
    is_low = low[1] < lip[1] and high[1] < bridge[1]
    below_chin = 15.0  # [mm] from the chin down to the top of a goatee; clothes begin lower
    is_low = is_low and high[1] > chin[1] - below_chin
    ear_depth = jaw_line[:, 2].min() - 30.0  # [mm]
    is_ahead = low[2] > ear_depth and centre[2] > jaw_line[:, 2].mean()
    is_central = abs(centre[0] - chin[0]) < 15.0
    return bool(is_low and is_ahead and is_central)


def _role_in_mouth(points: Floats64, centre: Floats64, mouth: _Mouth) -> str | None:
    """Return the role of a piece near the built-in teeth or tongue; None for other pieces."""
    is_in = ((points > mouth.low) & (points < mouth.high)).all(axis=1)
    if is_in.mean() < 0.8:
        return None
    width, height, depth = np.ptp(points, axis=0)
    # Walls of a mouth enclose the gums. A tongue may be as high if it reaches into the throat.
    if width > 0.85 * mouth.width and height > 35.0:
        return "mouth"
    if width > 20.0 and depth > 25.0 and _is_filled(points):
        # A palate lies above the edges of the teeth, and the floor of a mouth below them.
        if centre[1] < mouth.between < points[:, 1].max() + 5.0:
            return "tongue"
    return "upper_teeth" if centre[1] > mouth.between else "lower_teeth"


def _correct_teeth(pieces: list[FilePiece], rest: Floats64) -> list[FilePiece]:
    """Correct the roles of single teeth by the two rows that they form.

    The rows of a stranger's mouth rise toward the molars more than the built-in ones, so that lower
    molars can stand above the gap between the built-in rows.
    """
    widest = 15.0  # [mm] of a single tooth
    teeth = [
        place
        for place, piece in enumerate(pieces)
        if piece.role.endswith("_teeth") and np.ptp(rest[piece.vertices], axis=0)[0] < widest
    ]
    fewest = 8
    if len(teeth) < fewest:
        return pieces
    centres = np.array([pieces[place].centre for place in teeth])
    is_upper = np.array([pieces[place].role == "upper_teeth" for place in teeth])
    most_passes = 10
    for _ in range(most_passes):
        if is_upper.all() or not is_upper.any():
            return pieces
        # Both rows rise by the same slopes backward and aside, at different heights.
        matrix = np.column_stack([centres[:, [0, 2]], is_upper, ~is_upper])
        slopes = np.linalg.lstsq(matrix, centres[:, 1], rcond=None)[0]
        heights = centres[:, 1] - centres[:, [0, 2]] @ slopes[:2]
        before = is_upper
        is_upper = heights > slopes[2:].mean()
        if (is_upper == before).all():
            break
    rows = list(pieces)
    for place, upper in zip(teeth, is_upper, strict=True):
        role = "upper_teeth" if upper else "lower_teeth"
        rows[place] = replace(pieces[place], role=role)
    return rows


def _extent(values: Floats64) -> float:
    """Return the range (maximum minus minimum) of some numbers; 0 for no numbers."""
    return float(np.ptp(values)) if len(values) else 0.0


def corrected(pieces: Sequence[FilePiece], corrections: Sequence[str]) -> list[FilePiece]:
    """Set roles of pieces by options: "NUMBER=ROLE", "FIRST-LAST=ROLE" or "NAME=ROLE".

    Raises UserError for an unknown number, name or role.
    """
    roles: dict[int, str] = {}
    for text in corrections:
        which, _, role = text.rpartition("=")
        if role not in MOTION_OF_ROLE:
            raise UserError(
                f"--piece: was '{text}', must be NUMBER=ROLE or NAME=ROLE as the printed lines "
                f"have them; roles are {', '.join(MOTION_OF_ROLE)}"
            )
        named = [piece.number for piece in pieces if piece.name == which]
        roles.update(dict.fromkeys(named or _numbers_in(which, len(pieces)), role))
    return [replace(piece, role=roles.get(piece.number, piece.role)) for piece in pieces]


def _numbers_in(text: str, count: int) -> range:
    """Parse "3" or "4-20"; other text and numbers outside 1 to `count` raise UserError."""
    written = re.fullmatch(r"(\d{1,6})(?:-(\d{1,6}))?", text)
    first = int(written[1]) if written else 0
    last = int(written[2] or first) if written else 0
    if not 1 <= first <= last <= count:
        there = f"pieces 1 to {count}, none of this name" if count else "no piece beside the skin"
        raise UserError(
            f"--piece: '{text}': the file has {there}; leave the option out, or correct it"
        )
    return range(first, last + 1)


def described(pieces: Sequence[FilePiece]) -> list[str]:
    """Describe pieces in lines; four or more neighbours of one role share a line."""
    lines = []
    first = 0
    while first < len(pieces):
        last = first
        while last + 1 < len(pieces) and pieces[last + 1].role == pieces[first].role:
            last += 1
        if last - first < 3:
            last = first
        group = pieces[first : last + 1]
        count = sum(len(piece.vertices) for piece in group)
        what = MOTION_OF_ROLE[group[0].role]
        if len(group) == 1:
            x, y, z = group[0].centre
            label = f"piece {group[0].number}"
            where = f" at {x:.0f} {y:.0f} {z:.0f} mm"
        else:
            label = f"pieces {group[0].number}-{group[-1].number}"
            where = ""
        vertices = "1 vertex" if count == 1 else f"{count} vertices"
        lines.append(f"{label}{_names_in(group)}: {vertices}{where}: {what}")
        first = last + 1
    return lines


def _names_in(group: Sequence[FilePiece]) -> str:
    """Return at most three names of pieces in brackets; empty if no piece has a name."""
    names = list(dict.fromkeys(piece.name for piece in group if piece.name))
    if len(names) > 3:
        names[2:] = [f"{len(names) - 2} more"]
    return f" ({', '.join(names)})" if names else ""
