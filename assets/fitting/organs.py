"""Fit eyeballs, teeth, tongue and the inside of the mouth to another head.

Eyeballs stay round. The landmarks of each eye give a first ball, which is then fitted behind the
lids, so that the lids touch the ball all around. Teeth, gums and tongue stay rigid: a similarity
near the warp moves them. The walls of the mouth (mouth_walls.py) and the corners of the eyes bend
with the warp.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy

from ...geometry.arrays import Flags, Floats32, Floats64, Integers32
from ...geometry.directions import unit_vectors
from ...geometry.normals import cross_products, points_on_triangles, vertex_normals
from ..model import Eye, Head, Part
from ..topology import boundary_loops, grid_faces
from .eyeballs import ball_of_pieces, ball_of_socket
from .mouth_walls import WALL_NAME, FittedSkin, within_skin
from .warp import Similarity, ThinPlateSpline

EYE_LANDMARK_RANGES = {"right": slice(36, 42), "left": slice(42, 48)}
RIGID_PARTS = ("gums", "teeth", "tongue")  # beginnings of the names of rigid parts
LID_CLEARANCE = 0.3  # [mm] between the eyeball and the skin of the lids
RIM_ROWS = 8  # rows of a rim's vertices, from the lids' edge backward


def place_eyes(known: Head, fitted: FittedSkin) -> tuple[Eye, ...]:
    """Place the eyeballs of a head behind its lids.

    Position and size come from an eyeball in the file, else from a socket, else from the lids.
    Eyeballs and irises vary less between people than the widths of eyes, so their estimated sizes
    are scaled by the square root of the ratio of widths.
    """
    eyes = []
    lid_depth = 5.0  # [mm] from the landmarks on a lid's edge, within which skin belongs to the lid
    for eye in known.eyes:
        around = EYE_LANDMARK_RANGES[eye.name]
        source = known.vertices[known.landmarks[around]]
        target = fitted.landmarks[around]
        scale = _eye_width(target) / _eye_width(source)
        centre = target.mean(axis=0) + scale * (eye.centre - source.mean(axis=0))
        scale = float(np.sqrt(scale))
        away = fitted.vertices - centre
        outward = (fitted.normals * away).sum(axis=1) / np.linalg.norm(away, axis=1)
        near_lids = scipy.spatial.cKDTree(target)
        from_landmarks, _ = near_lids.query(fitted.vertices)
        # Skin that faces the ball is the wall of a socket, not a lid. A socket may be too narrow.
        is_lid = (outward > -0.5) & (from_landmarks < lid_depth)
        corners = is_lid[fitted.faces]
        between = _points_between(fitted, corners.all(axis=1), centre)
        # On heads of few triangles, some reach from a lid to the brow.
        partly = _points_between(fitted, corners.any(axis=1), centre)
        partly = partly[near_lids.query(partly)[0] < lid_depth]
        skin = np.vstack([target, fitted.vertices[is_lid], between])
        iris = scale * eye.iris_radius
        centre, radius = _behind_lids(centre, scale * eye.radius, target.mean(axis=0), skin)
        own = ball_of_pieces(fitted.pieces, centre, radius, target)
        socket = ball_of_socket(fitted.vertices, outward, centre, radius)
        if own is None and socket is None:
            iris = radius / eye.radius * eye.iris_radius
        centre, radius = own or socket or (centre, radius)
        if own is not None:
            radius = _within_lids(centre, radius, target)
        most_iris = 0.8  # greatest radius of an iris, in radii of the ball; some balls are small
        iris = min(iris, most_iris * radius)
        if own is None:
            centre[2] += _forward_clearance(centre, radius + LID_CLEARANCE, skin)
            centre[2] += min(_forward_clearance(centre, radius, partly), 0.0)
        eyes.append(Eye(eye.name, centre, radius, iris))
    return tuple(eyes)


def _within_lids(centre: Floats64, radius: float, lids: Floats64) -> float:
    """Return the radius of a file's eyeball, smaller if the ball would pierce the lids' corners.

    Some makers' balls do, and a dark scrap would stay beside the corner of a shut eye.

    lids: landmarks of the eye [mm], (6, 3).
    """
    most_shrunk = 0.05  # relative to the radius
    nearest = float(np.linalg.norm(lids - centre, axis=1).min())
    clearance = 0.2  # [mm] between ball and landmark
    return float(np.clip(nearest - clearance, (1.0 - most_shrunk) * radius, radius))


def _points_between(fitted: FittedSkin, is_chosen: Flags, centre: Floats64) -> Floats64:
    """Return points all over the long ones of chosen triangles, on their outer sides [mm], (n, 3).

    A long flat triangle is deeper in its middle than at its corners, and the ball would pierce it.

    is_chosen: flags of the skin's triangles, (F,). centre: an estimate of the ball's centre, (3,).
    """
    faces = fitted.faces[is_chosen]
    corners = fitted.vertices[faces]
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    long_edge = 4.0  # [mm]; the middle of such an edge is 0.2 mm deeper than its ends
    is_long = lengths.max(axis=1, initial=0.0) > long_edge
    away = corners.mean(axis=1) - centre
    is_outer = (cross_products(fitted.vertices, faces) * away).sum(axis=1) > 0.0
    return points_on_triangles(fitted.vertices, faces[is_long & is_outer])


def _eye_width(points: Floats64) -> float:
    """Return the distance between the corners of an eye [mm]; points: its landmarks, (6, 3)."""
    return float(np.linalg.norm(points[3] - points[0]))


def _behind_lids(
    centre: Floats64, radius: float, opening: Floats64, skin: Floats64
) -> tuple[Floats64, float]:
    """Find centre and radius [mm] of the sphere that touches the lids from behind all around.

    centre, radius: an estimate. opening: centre of the opening, (3,). skin: points of the lids,
    (n, 3).
    """
    x, y, _ = (skin - opening).T
    around = np.arctan2(y, x)
    turns = (around / np.pi + 1.0) / 2.0  # 0 to 1
    sector_count = 12  # around an eye; in each sector the nearest skin should touch the eyeball
    sector = np.floor(turns * sector_count).astype(int) % sector_count
    parts = [skin[sector == k] for k in np.unique(sector)]

    def off(values: Floats64) -> Floats64:
        """Return errors of the sphere: gaps to the lids in sectors, sideways shift, growth."""
        size = radius * np.exp(values[3])
        distances = [np.linalg.norm(part - values[:3], axis=1).min() for part in parts]
        gaps = np.array(distances) - (size + LID_CLEARANCE)
        aside_cost = 2.0  # per millimetre, because an eye lies behind the centre of its opening
        aside = aside_cost * (values[:2] - centre[:2])
        size_cost = 20.0  # [mm] for a sphere twice as large
        sunk_cost = 3.0  # cost of skin inside the ball, relative to a gap in front of it
        gap_errors = np.where(gaps < 0.0, sunk_cost * gaps, gaps)
        growth_error = size_cost * values[3]
        return np.concatenate([gap_errors, aside, [growth_error]])

    # [mm]; sectors with a greater error count less, because the corners of an eye are off the ball.
    touching_distance = 0.5
    found = scipy.optimize.least_squares(
        off, np.append(centre, 0.0), loss="soft_l1", f_scale=touching_distance
    ).x
    return found[:3], radius * float(np.exp(found[3]))


def _forward_clearance(centre: Floats64, radius: float, skin: Floats64) -> float:
    """Return how far a sphere can move forward until it touches the skin (n, 3) [mm]."""
    away = skin - centre
    across = np.linalg.norm(away[:, :2], axis=1)
    in_front = (away[:, 2] > 0.0) & (across < radius)
    if not in_front.any():
        return 0.0
    height = np.sqrt(radius**2 - across[in_front] ** 2)
    return float((away[in_front, 2] - height).min())


def lids_on_eyes(
    known: Head, vertices: Floats64, eyes: Sequence[Eye], fractions: Sequence[float]
) -> Floats64:
    """Move the lids to the same distance from the eyes as on the built-in head.

    The corners of the eye stay, because they rest on flesh. eyes: in the order of `known.eyes`.
    fractions: for each ring of vertices around the eye, from the lids' edge outward, the fraction
    of the whole motion. Returns vertices [mm], (V, 3).
    """
    placed = vertices.copy()
    for old, new in zip(known.eyes, eyes, strict=True):
        for row, fraction in enumerate(fractions):
            ring = known.rings[f"eye_{row}_{old.name}"]
            ring = np.delete(ring, [0, len(ring) // 2])
            above = np.linalg.norm(known.vertices[ring] - old.centre, axis=1) / old.radius
            away = vertices[ring] - new.centre
            nearer = new.radius * above / np.linalg.norm(away, axis=1) - 1.0
            placed[ring] += fraction * nearer[:, None] * away
    return placed


def place_parts(
    known: Head,
    fitted: FittedSkin,
    warp: ThinPlateSpline,
    eyes: tuple[Eye, ...],
    jaws: Sequence[Floats64],
    *,
    kept_bone: str = "",
) -> tuple[Part, ...]:
    """Fit the parts inside the built-in head into another head.

    warp: from the built-in head to the other head. jaws: motions of the mandible, see
    `opened_jaws`. kept_bone: bone whose parts are not changed.
    """
    mouth = _mouth_of(known, fitted, warp)
    rises = _rises_of_jaws(known, fitted.landmarks, mouth)
    balls = {f"eye_{old.name}": (old, new) for old, new in zip(known.eyes, eyes, strict=True)}
    parts = []
    for part in known.parts:
        if part.bone in balls:
            placed = _resized_eyeball(part, *balls[part.bone])
        elif part.name.startswith(RIGID_PARTS):
            rise = np.array([0.0, rises[part.bone == "mandible"], 0.0])
            placed = _moved_part(part, replace(mouth, shift=mouth.shift + rise))
        elif part.bone == kept_bone:
            placed = part
        else:
            placed = _bent_part(part, warp)
        parts.append(placed)
    walls = [number for number, part in enumerate(parts) if part.name.startswith(WALL_NAME)]
    placed_walls = within_skin([parts[number] for number in walls], fitted, mouth, jaws)
    for number, wall in zip(walls, placed_walls, strict=True):
        parts[number] = wall
    return tuple(parts)


def _mouth_of(known: Head, fitted: FittedSkin, warp: ThinPlateSpline) -> Similarity:
    """Find the similarity that moves all rigid parts of the mouth, as one body, behind the skin."""
    found = [
        part.vertices.astype(np.float64)
        for part in known.parts
        if part.name.startswith(RIGID_PARTS)
    ]
    mouth_landmarks = slice(48, 68)
    stiff = np.vstack([*found, known.vertices[known.landmarks[mouth_landmarks]]])
    mouth = Similarity.between(stiff, warp.points(stiff))
    placed = mouth.points(np.vstack(found)) if found else np.zeros((0, 3))
    least_forward = 0.2  # z of a normal; skin with a larger one may be in front of teeth
    skin = fitted.vertices[fitted.normals[:, 2] > least_forward]
    neighbour_count = 3
    seen_from_front = scipy.spatial.cKDTree(skin[:, :2])
    distance, beside = seen_from_front.query(placed[:, :2], k=neighbour_count)
    clearance = 4.0  # [mm] in x and y; teeth and gums stay behind nearer skin
    skin_front = np.where(distance < clearance, skin[beside, 2], np.inf).min(axis=1)
    stiff_depth = 2.5  # [mm] from teeth and gums to the skin; lips and cheeks are thicker
    protruding = placed[:, 2] - (skin_front - stiff_depth)
    farthest_back = 10.0  # [mm]; greatest motion of the teeth backward
    back = float(np.clip(protruding.max(initial=0.0), 0.0, farthest_back))
    return replace(mouth, shift=mouth.shift - np.array([0.0, 0.0, back]))


def _rises_of_jaws(known: Head, landmarks: Floats64, mouth: Similarity) -> tuple[float, float]:
    """Return how far the upper and the lower teeth move up [mm], relative to a shut mouth.

    If a mouth is open at rest, each row of teeth moves with its lip. Otherwise shut teeth with much
    gum would show between the lips. landmarks: points [mm], (68, 3).
    """
    inner_lips = slice(61, 64), slice(65, 68)
    upper, lower = (landmarks[lip, 1].mean() for lip in inner_lips)
    most_of_shut = 3.0  # [mm] between the lips, up to which the teeth stay shut
    if upper - lower <= most_of_shut:
        return 0.0, 0.0
    own = mouth.points(known.vertices[known.landmarks])
    own_upper, own_lower = (own[lip, 1].mean() for lip in inner_lips)
    return float(upper - own_upper), float(lower - own_lower)


def _moved_part(part: Part, similarity: Similarity) -> Part:
    """Move a part without changing its shape."""
    normals = part.normals @ similarity.rotation.T
    return replace(
        part,
        vertices=similarity.points(part.vertices).astype(np.float32),
        normals=normals.astype(np.float32),
    )


def _resized_eyeball(part: Part, old: Eye, new: Eye) -> Part:
    """Give an eyeball the size, the position and the iris of another eye."""
    away = part.vertices - old.centre
    reach = np.linalg.norm(away, axis=1)
    angle = np.arccos(away[:, 2] / reach)  # from the pupil, seen from the ball's centre
    old_iris = np.arcsin(old.iris_radius / old.radius)
    new_iris = np.arcsin(new.iris_radius / new.radius)
    placed = np.interp(angle, [0.0, old_iris, np.pi], [0.0, new_iris, np.pi])
    beside = unit_vectors(away[:, :2])
    directions = np.column_stack([np.sin(placed)[:, None] * beside, np.cos(placed)])
    bulge = new.iris_radius / old.iris_radius * (reach - old.radius)
    vertices = new.centre + (new.radius + bulge)[:, None] * directions
    normals = vertex_normals(vertices, part.faces)
    return replace(part, vertices=vertices.astype(np.float32), normals=normals.astype(np.float32))


def _bent_part(part: Part, warp: ThinPlateSpline) -> Part:
    """Bend a part by a warp."""
    vertices = warp.points(part.vertices)
    ahead = warp.points(part.vertices + part.normals) - vertices
    normals = unit_vectors(ahead)
    return replace(part, vertices=vertices.astype(np.float32), normals=normals.astype(np.float32))


def with_eyelid_rims(
    parts: Sequence[Part], vertices: Floats64, faces: Integers32, eyes: Sequence[Eye]
) -> tuple[Part, ...]:
    """Add rims of flesh between the lids and the eyeballs to the parts of a head.

    The built-in lids reach behind the front of the ball, and flesh fills the corners of the eye.
    The lids of other meshes may end in front of the ball. Without a rim, a gap into the empty head
    would show. Lids that end far in front of the ball do not cover the flesh in the corners, which
    would be a lump there; they get a rim alone.

    vertices: vertices of the skin [mm], (V, 3). faces: triangles of the skin, (F, 3).
    """
    loops = [(eye, _edge_around(eye, vertices, faces)) for eye in eyes]
    bare = [eye for eye, loop in loops if not loop or not _lies_on(eye, vertices[loop])]
    flesh = "eye_corners"  # rims belong to this part and have its colour
    placed = []
    for part in parts:
        if part.name == flesh:
            colour = part.colours.mean(axis=0)
            part = _without_corners(part, bare)
            rims = [_rim_of(eye, vertices[loop]) for eye, loop in loops if loop]
            part = _with_rims(part, rims, colour)
            if not len(part.faces):
                continue
        placed.append(part)
    return tuple(placed)


def _without_corners(part: Part, bare: Sequence[Eye]) -> Part:
    """Remove the flesh of eyes whose sockets are closed, or whose lids do not cover it."""
    centres = part.vertices.astype(np.float64)[part.faces].mean(axis=1)
    most_radii = 2.0  # greatest distance of flesh from its eye, in radii of the eyeball
    stays = np.ones(len(part.faces), np.bool_)
    for eye in bare:
        stays &= np.linalg.norm(centres - eye.centre, axis=1) > most_radii * eye.radius
    used, faces = np.unique(part.faces[stays], return_inverse=True)
    return replace(
        part,
        vertices=part.vertices[used],
        faces=faces.reshape(-1, 3).astype(np.int32),
        normals=part.normals[used],
        colours=part.colours[used],
    )


def _edge_around(eye: Eye, vertices: Floats64, faces: Integers32) -> list[int]:
    """Find the skin's edge around an eye: vertices in the order of faces; [] for no edge."""
    most_radii = 2.2  # greatest distance of the edge from the ball's centre, in radii
    reach = most_radii * eye.radius
    away = np.linalg.norm(vertices - eye.centre, axis=1)
    near = faces[(away[faces] < 2.0 * reach).any(axis=1)]  # all faces would take a second
    loops = boundary_loops(near)
    return next((loop for loop in loops if away[loop].max() < reach), [])


def _lies_on(eye: Eye, edge: Floats64) -> bool:
    """Whether the edge of the skin around an eye, (n, 3) [mm], lies on its eyeball."""
    most_gap = 1.0  # [mm] in the mean; 0.3 on a modelled head, 1.7 to 5 where scans were cut open
    return bool(np.linalg.norm(edge - eye.centre, axis=1).mean() - eye.radius < most_gap)


def _rim_of(eye: Eye, edge: Floats64) -> tuple[Floats64, Integers32]:
    """Make a rim: its vertices row by row, (RIM_ROWS n, 3), and its faces, which face forward.

    From each point of the skin's edge, a line of vertices runs backward around the ball, and
    approaches the ball. edge: points of the skin's edge [mm], (n, 3), in the order of its faces.
    """
    away = edge - eye.centre
    length = np.linalg.norm(away, axis=1)
    beside = unit_vectors(away * [1.0, 1.0, 0.0])
    start = np.arccos(away[:, 2] / length)
    rim_depth = 3.0  # [mm] from the equator of the ball back to the end of a rim
    end = np.maximum(0.5 * np.pi + np.arcsin(rim_depth / eye.radius), start)
    fraction = np.linspace(0.0, 1.0, RIM_ROWS)[:, None]
    angle = (1.0 - fraction) * start + fraction * end
    tucked_depth = 0.2  # [mm] from the lids inward to the beginning of a rim
    sunk_depth = 0.3  # [mm] from the ball's surface inward to the end of a rim
    reach = (1.0 - fraction) * (length + tucked_depth) + fraction * (eye.radius - sunk_depth)
    forward = np.array([0.0, 0.0, 1.0])
    aside = np.sin(angle)[..., None] * beside
    ahead = np.cos(angle)[..., None] * forward
    directions = aside + ahead
    points = eye.centre + (reach[..., None] * directions).reshape(-1, 3)
    rows = np.arange(len(points)).reshape(RIM_ROWS, -1)
    return points, grid_faces(rows, closed=True)


def _with_rims(part: Part, rims: Sequence[tuple[Floats64, Integers32]], colour: Floats32) -> Part:
    """Add rims of a colour (3,) to a part; they become darker toward their rear ends."""
    least_light = 0.6  # fraction of light at the rear end of a rim
    for points, faces in rims:
        light = np.repeat(np.linspace(1.0, least_light, RIM_ROWS), len(points) // RIM_ROWS)
        part = replace(
            part,
            faces=np.concatenate([part.faces, faces + np.int32(len(part.vertices))]),
            vertices=np.concatenate([part.vertices, points], dtype=np.float32),
            normals=np.concatenate([part.normals, vertex_normals(points, faces)], dtype=np.float32),
            colours=np.concatenate([part.colours, light[:, None] * colour], dtype=np.float32),
        )
    return part
