"""The 68 iBug landmarks and the named anatomical points, as vertex numbers.

Source of the numbering: Sagonas et al. 2013, "300 Faces in-the-Wild Challenge": 0-16 jaw line from
the subject's right ear, 17-26 brows, 27-35 nose, 36-47 eyes, 48-59 outer lips, 60-67 inner lips.
"""

import numpy as np

from ..topology import Faces
from .eye_rows import COLUMNS as EYE_COLUMNS
from .mouth_rows import BORDER_ROW, CREST_ROW, SEAM_ROW, SIDE
from .skin import SkinMesh

# Landmarks of the mid-plane and of the left half by the name of their vertex.
BY_NAME = {
    8: "menton", 9: "jaw_9", 10: "jaw_10", 11: "jaw_11", 12: "jaw_12", 13: "jaw_13",
    14: "jaw_14", 15: "jaw_15", 16: "tragion",
    22: "brow_22", 23: "brow_23", 24: "brow_24", 25: "brow_25", 26: "brow_26",
    27: "nasion", 28: "rhinion", 29: "supratip", 30: "pronasale",
    33: "subnasale", 34: "nostril_sill", 35: "alar_base",
}  # fmt: skip
LID_MARGIN = "eye_2"
EYE_LANDMARK_COLUMNS = {42: 0, 43: 3, 44: 7, 45: 10, 46: 13, 47: 17}
BORDER_COLUMNS = {51: 0, 52: 1, 53: 4, 55: 2 * SIDE - 4, 56: 2 * SIDE - 2, 57: 2 * SIDE}
CORNER = {54: SIDE}  # where the lips meet: the border of the red passes outside of it
SEAM_COLUMNS = {62: 0, 63: 4, 64: SIDE, 65: 2 * SIDE - 4, 66: 2 * SIDE}
# Left landmark -> its mirror image on the right.
OPPOSITE = {
    9: 7, 10: 6, 11: 5, 12: 4, 13: 3, 14: 2, 15: 1, 16: 0,
    22: 21, 23: 20, 24: 19, 25: 18, 26: 17, 34: 32, 35: 31,
    42: 39, 43: 38, 44: 37, 45: 36, 46: 41, 47: 40,
    52: 50, 53: 49, 54: 48, 55: 59, 56: 58, 63: 61, 64: 60, 65: 67,
}  # fmt: skip
# Names that are anatomy, not only numbers of landmarks.
MIDLINE_NAMES = (
    "vertex", "trichion", "metopion", "glabella", "nasion", "rhinion", "supratip", "pronasale",
    "subnasale", "sublabiale", "pogonion", "gnathion", "menton", "cervicale",
)  # fmt: skip
PAIRED_NAMES = (
    "orbitale", "cheek", "nostril_sill", "nostril_roof", "alar_base", "frontotemporale",
    "tragion", "zygion", "gonion", "temple",
)  # fmt: skip


def landmark_vertices(skin: SkinMesh) -> Faces:
    """Vertex numbers of the 68 landmarks, shape (68,), int32."""
    left = {number: skin.names[name] for number, name in BY_NAME.items()}
    rows = (
        (EYE_LANDMARK_COLUMNS, LID_MARGIN),
        (BORDER_COLUMNS, f"mouth_{BORDER_ROW}"),
        (CORNER, f"mouth_{CREST_ROW}"),
        (SEAM_COLUMNS, f"mouth_{SEAM_ROW}"),
    )
    for columns, row in rows:
        left |= {number: skin.rings[row][column] for number, column in columns.items()}
    vertices = np.full(68, -1, dtype=np.int32)
    for number, vertex in left.items():
        vertices[number] = vertex
        if number in OPPOSITE:
            vertices[OPPOSITE[number]] = skin.mirror[vertex]
    return vertices


def anatomy(skin: SkinMesh) -> dict[str, int]:
    """Named anatomical points; those of both sides end in _left and _right."""
    border, seam = skin.rings[f"mouth_{BORDER_ROW}"], skin.rings[f"mouth_{SEAM_ROW}"]
    margin, half = skin.rings["eye_1"], EYE_COLUMNS // 2
    heights = skin.vertices[margin, 1]
    wing = _alare(skin)
    single = {name: skin.names[name] for name in MIDLINE_NAMES}
    single |= {"labiale_superius": border[0], "labiale_inferius": border[-1], "stomion": seam[0]}
    paired = {name: skin.names[name] for name in PAIRED_NAMES}
    paired |= {
        "alare": wing,
        "cheilion": skin.rings[f"mouth_{CREST_ROW}"][SIDE],
        "crista_philtri": border[BORDER_COLUMNS[52]],
        "endocanthion": margin[0],
        "exocanthion": margin[half],
        "palpebrale_superius": margin[int(np.argmax(heights))],
        "palpebrale_inferius": margin[int(np.argmin(heights))],
    }
    for name, vertex in paired.items():
        single[f"{name}_left"] = int(vertex)
        single[f"{name}_right"] = int(skin.mirror[vertex])
    return single


def _alare(skin: SkinMesh) -> int:
    """The most lateral vertex of the left wing of the nose, in front of its crease."""
    crease = skin.vertices[skin.rings["alar_crease"]]
    points = skin.vertices
    on_wing = (
        (points[:, 0] > 0)
        & (points[:, 0] < 20.0)
        & (points[:, 1] > crease[:, 1].min())
        & (points[:, 1] < crease[:, 1].max())
        & (points[:, 2] > crease[:, 2].max() + 2.0)
    )
    return int(np.argmax(np.where(on_wing, points[:, 0], -np.inf)))
