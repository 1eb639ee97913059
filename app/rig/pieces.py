"""The pieces of a head's file: connected triangles, and the role of each.

A piece is an eyeball, teeth, the tongue, lashes, hair, a body. The skin, which the landmarks lie
on, is none of them. A piece is known by its place: eyeballs are round and lie behind the lids;
what lies in the mouth is where the built-in teeth and tongue were fitted.
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
from risorius.assets.fitting.mesh_validation import pieces_of
from risorius.geometry.arrays import Floats64, Integers32

from ..errors import UserError

ROLES = {  # of a piece, and how it moves
    "eye_left": "eyeball, turns with the left eye",
    "eye_right": "eyeball, turns with the right eye",
    "upper_teeth": "upper teeth or gums, still with the cranium",
    "lower_teeth": "lower teeth or gums, moves with the mandible",
    "tongue": "tongue, bends",
    "mouth": "inside of the mouth, stretches between both jaws",
    "on_skin": "lies on the skin, moves with it: lashes, brows",
    "hair": "hair or a helmet, still with the cranium",
    "body": "body or clothes, still",
}
IN_MOUTH = ("teeth", "gums", "tongue")  # how names of built-in parts begin
AROUND_MOUTH = 6.0  # [mm] about these parts, in which parts of a mouth are looked for
FACE = slice(17, 68)  # landmarks, without the jaw line
BESIDE = 12.0  # [mm] about these, in which lashes and brows are looked for
CHIN = 8  # landmark


@dataclass(frozen=True)
class FilePiece:
    """Vertices of a file that hang together, and their role.

    number: by which an option names it. vertices: their numbers, shape (n,). role: of ROLES.
    middle: of its box [mm], shape (3,).
    """

    number: int
    vertices: npt.NDArray[np.integer]
    role: str
    middle: Floats64


def find_pieces(
    rest: Floats64, faces: Integers32, skin: npt.NDArray[np.integer], head: FittedHead
) -> list[FilePiece]:
    """The pieces of a file beside the one that the skin belongs to, in the order of the file.

    rest: all vertices [mm], shape (V, 3). faces: shape (F, 3). skin: vertices of the skin.
    """
    piece = pieces_of(faces, len(rest))
    order = np.argsort(piece, kind="stable")
    starts = np.flatnonzero(np.diff(piece[order], prepend=-1))
    used = np.zeros(len(rest), np.bool_)
    used[faces] = True
    skins = np.unique(piece[skin])
    near = scipy.spatial.cKDTree(head.vertices)
    groups = [
        group
        for group in np.split(order, starts[1:])
        if used[group[0]] and piece[group[0]] not in skins
    ]
    groups.sort(key=lambda group: int(group[0]))
    found = []
    for number, group in enumerate(groups, start=1):
        points = rest[group]
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        found.append(FilePiece(number, group, _role_of(points, middle, head, near), middle))
    return found


def _role_of(
    points: Floats64, middle: Floats64, head: FittedHead, near: scipy.spatial.cKDTree
) -> str:
    """What a piece is taken for. points: its vertices [mm], shape (n, 3)."""
    for eye in head.eyes:
        if is_eyeball(points, eye.centre, eye.radius):
            return f"eye_{eye.name}"
    role = _role_in_mouth(points, middle, head)
    if role is not None:
        return role
    landmarks = head.vertices[head.landmarks]
    face = landmarks[FACE]
    is_on_face = (middle > face.min(axis=0) - BESIDE) & (middle < face.max(axis=0) + BESIDE)
    distance = near.query(points)[0]
    # A lash ends 20 mm off the lid; a piece farther off hangs before the face, as glasses do.
    if is_on_face.all() and distance.min() < 4.0 and distance.max() < 20.0:
        return "on_skin"
    # A collar reaches up to the chin; long hair hangs down from above it.
    if points[:, 1].max() < landmarks[CHIN, 1]:
        return "body"
    return "hair"


def _role_in_mouth(points: Floats64, middle: Floats64, head: FittedHead) -> str | None:
    """What a piece is that lies where the built-in teeth and tongue do; None for others."""
    parts = {part.name: part.vertices for part in head.parts if part.name.startswith(IN_MOUTH)}
    if not {"teeth_upper", "teeth_lower", "tongue"} <= set(parts):
        return None
    around = np.vstack([*parts.values()])
    low = around.min(axis=0) - np.array([AROUND_MOUTH, AROUND_MOUTH, 25.0])
    high = around.max(axis=0) + np.array([AROUND_MOUTH, AROUND_MOUTH, 2.0])
    is_in = ((points > low) & (points < high)).all(axis=1)
    if is_in.mean() < 0.8:
        return None
    between = 0.5 * (parts["teeth_upper"][:, 1].min() + parts["teeth_lower"][:, 1].max())
    width, height, depth = np.ptp(points, axis=0)
    # A row of teeth is hollow in its middle, where a tongue and a palate have their bodies.
    is_middle = np.abs(points[:, 0] - middle[0]) < 0.15 * width
    is_filled = _extent(points[is_middle, 2]) > 0.6 * depth
    if width > 20.0 and height > 35.0:
        return "mouth"
    if width > 20.0 and depth > 25.0 and is_filled:
        # A palate is above the teeth's edges, the floor of a mouth below.
        if middle[1] < between < points[:, 1].max() + 5.0:
            return "tongue"
    return "upper_teeth" if middle[1] > between else "lower_teeth"


def _extent(values: Floats64) -> float:
    """From the least to the greatest of some numbers; 0 for none."""
    return float(np.ptp(values)) if len(values) else 0.0


def corrected(pieces: Sequence[FilePiece], corrections: Sequence[str]) -> list[FilePiece]:
    """Pieces with the roles that options give them, each "NUMBER=ROLE" or "FIRST-LAST=ROLE".

    Raises UserError for a number or a role that there is not.
    """
    roles: dict[int, str] = {}
    for text in corrections:
        written = re.fullmatch(r"(\d{1,6})(?:-(\d{1,6}))?=(\w+)", text)
        if written is None or written[3] not in ROLES:
            raise UserError(
                f"--piece: was '{text}', must be NUMBER=ROLE as the printed lines number them; "
                f"roles are {', '.join(ROLES)}"
            )
        first = int(written[1])
        last = int(written[2] or first)
        if not 1 <= first <= last <= len(pieces):
            raise UserError(f"--piece: '{text}': the file has pieces 1 to {len(pieces)}")
        roles.update(dict.fromkeys(range(first, last + 1), written[3]))
    return [replace(piece, role=roles.get(piece.number, piece.role)) for piece in pieces]


def described(pieces: Sequence[FilePiece]) -> list[str]:
    """A line for each piece; neighbours of one role, such as strands of hair, share one."""
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
        what = ROLES[group[0].role]
        if len(group) == 1:
            x, y, z = group[0].middle
            name = f"piece {group[0].number}"
            where = f" at {x:.0f} {y:.0f} {z:.0f} mm"
        else:
            name = f"pieces {group[0].number}-{group[-1].number}"
            where = ""
        vertices = "1 vertex" if count == 1 else f"{count} vertices"
        lines.append(f"{name}: {vertices}{where}: {what}")
        first = last + 1
    return lines
