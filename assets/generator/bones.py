"""What the skin knows of the skull: how deep it lies, and which bone carries it.

Depths: chosen, in the range that adult tables have. The pooled means (Stephan and Simpson 2008,
"Facial soft tissue depths in craniofacial identification (part I)", J. Forensic Sci. 53:1257-1272)
were not read in print; what was read stands in docs/head.md, and a test compares. Gonion,
zygion and lower molar are deeper by what a later pooling adds (Hona and Stephan 2024, abstract).
Points that such tables lack (lids, temple, neck) are marked.
Weights: the lower lip and the chin follow the mandible, everything above the mouth the cranium; the
slit of the mouth is a real gap in the mesh, so nothing leaks across it.
"""

import numpy as np
import numpy.typing as npt
import scipy
from scipy import sparse
from scipy.sparse.linalg import spsolve

from risorius.geometry.normals import cross_products

from ..topology import edge_faces
from .fields import Points, Values
from .form import from_front
from .mouth_rows import BORDER_ROW, COLUMNS, SEAM_ROW
from .skin import SkinMesh

DEPTH_BY_NAME = {
    "vertex": 5.0, "trichion": 4.5, "metopion": 5.0, "glabella": 5.5, "nasion": 6.5,
    "rhinion": 3.0, "subnasale": 13.0, "sublabiale": 11.0, "pogonion": 11.5, "gnathion": 8.5,
    "menton": 7.0,
    "brow_24": 6.0, "orbitale": 7.0, "alar_base": 9.5, "zygion": 8.0, "gonion": 13.0,
    # chosen: no bone beneath (cartilage of the nose, throat), temporal muscle, parotid
    "cheek": 12.0, "supratip": 6.0, "pronasale": 16.0, "cervicale": 16.0, "temple": 9.0,
    "tragion": 9.0, "frontotemporale": 5.5, "brow_22": 6.0, "brow_26": 6.0, "jaw_15": 17.0,
}  # fmt: skip
# x, y in front view [mm], depth [mm]: over canines and second molars, above and below
DEPTH_IN_FRONT = (
    (0.0, -53.0, 11.0), (15.0, -54.0, 9.5), (15.0, -84.0, 10.5), (45.0, -50.0, 26.0),
    (44.0, -74.0, 24.0), (30.0, -100.0, 11.0), (32.0, -36.0, 15.0),
)  # fmt: skip
LIP_DEPTH = 12.0  # [mm] on the red
LID_DEPTH = 4.0  # [mm] chosen: to the eyeball, for want of bone
NECK_DEPTH, NECK_TOP = 20.0, -140.0  # [mm] chosen: muscles of the neck
LEAST_DEPTH, LARGEST_DEPTH = 2.5, 27.0

# Share of the mandible along the columns of the lips, from the middle of the upper lip over the
# corner to the middle of the lower lip; chosen so that the open mouth is an oval.
LIP_WEIGHTS = (
    0.0, 0.0, 0.0, 0.01, 0.03, 0.08, 0.18, 0.34, 0.51, 0.65, 0.78, 0.88, 0.95, 0.98, 1.0,
)  # fmt: skip
MANDIBLE_SHARE = {
    "sublabiale": 1.0, "pogonion": 1.0, "gnathion": 1.0, "menton": 1.0, "jaw_9": 1.0,
    "jaw_10": 0.95, "jaw_11": 0.6, "jaw_12": 0.22, "jaw_13": 0.05, "jaw_14": 0.0, "jaw_15": 0.0,
    "subnasale": 0.0, "alar_base": 0.0, "nostril_sill": 0.0, "cervicale": 0.55,
}  # fmt: skip
STILL_ABOVE, STILL_BEHIND, STILL_BELOW = -34.0, 8.0, -143.0  # y, z, y [mm]: cranium only
SMOOTHNESS = 6.0  # [mm^2]; chosen: seeds are met within 5 %, no cusp is left around them

CONDYLE = np.array([52.0, -12.0, 15.0])  # [mm] left; 10 mm in front of the tragus, 18 deep


def jaw_axis() -> Points:
    """Centres of the right and the left condyle [mm], shape (2, 3)."""
    return np.array([CONDYLE * [-1.0, 1.0, 1.0], CONDYLE])


def _laplacian(skin: SkinMesh) -> tuple[sparse.csr_matrix, Values]:
    """Graph Laplacian with weights area / length^2 and the area that belongs to each vertex."""
    area = 0.5 * np.linalg.norm(cross_products(skin.vertices, skin.faces), axis=1)
    beside = edge_faces(skin.faces)
    first, second = np.array(list(beside)).T
    length = np.linalg.norm(skin.vertices[first] - skin.vertices[second], axis=1)
    shared = np.array([area[faces].sum() for faces in beside.values()])
    shared = shared / np.maximum(length, 0.5) ** 2
    count = len(skin.vertices)
    weights = sparse.coo_matrix((shared, (first, second)), shape=(count, count))
    weights = (weights + weights.T).tocsr()
    mass = np.zeros(count)
    np.add.at(mass, skin.faces.ravel(), np.repeat(area / 3.0, 3))
    degree = np.asarray(weights.sum(axis=1)).ravel()
    return (sparse.diags(degree) - weights).tocsr(), mass


def _interpolate(skin: SkinMesh, seeds: dict[int, float]) -> Values:
    """The smoothest values over the mesh that meet the seeds, the same on both sides."""
    laplacian, mass = _laplacian(skin)
    both = seeds | {int(skin.mirror[vertex]): value for vertex, value in seeds.items()}
    pull = np.zeros(len(skin.vertices))
    wanted = np.zeros(len(skin.vertices))
    for vertex, value in both.items():
        pull[vertex], wanted[vertex] = 1.0, value
    bending = laplacian.T @ sparse.diags(1.0 / np.maximum(mass, 0.5)) @ laplacian
    system = sparse.diags(pull) + SMOOTHNESS * bending
    values = spsolve(system.tocsc(), pull * wanted)
    return np.asarray(0.5 * (values + values[skin.mirror]), dtype=np.float64)


def _nearest(skin: SkinMesh, points: Points) -> npt.NDArray[np.int64]:
    return np.asarray(scipy.spatial.cKDTree(skin.vertices).query(points)[1])


def bone_depth(skin: SkinMesh) -> Values:
    """Distance from the skin to the bone beneath [mm], shape (V,)."""
    seeds = {skin.names[name]: depth for name, depth in DEPTH_BY_NAME.items()}
    x, y, depths = np.array(DEPTH_IN_FRONT).T
    seeds |= dict(zip(_nearest(skin, from_front(x, y)).tolist(), depths.tolist(), strict=True))
    for row in range(SEAM_ROW, BORDER_ROW + 1):
        seeds |= dict.fromkeys(skin.rings[f"mouth_{row}"], LIP_DEPTH)
    for row in range(4):
        seeds |= dict.fromkeys(skin.rings[f"eye_{row}"], LID_DEPTH)
    low = np.flatnonzero(skin.vertices[:, 1] < NECK_TOP)
    seeds |= dict.fromkeys(low.tolist(), NECK_DEPTH)
    return np.clip(_interpolate(skin, seeds), LEAST_DEPTH, LARGEST_DEPTH)


def mandible_weight(skin: SkinMesh) -> Values:
    """Share of the mandible in the motion of each vertex, 0 to 1, shape (V,)."""
    _, y, z = skin.vertices.T
    is_still = (y > STILL_ABOVE) | (z < STILL_BEHIND) | (y < STILL_BELOW)
    seeds = dict.fromkeys(np.flatnonzero(is_still).tolist(), 0.0)
    seeds |= {skin.names[name]: share for name, share in MANDIBLE_SHARE.items()}
    for row in range(BORDER_ROW + 1):
        numbers = skin.rings[f"mouth_{row}"]
        seeds |= {numbers[column]: LIP_WEIGHTS[column] for column in range(COLUMNS)}
    weight = np.clip(_interpolate(skin, seeds), 0.0, 1.0)
    weight[is_still] = 0.0
    return weight
