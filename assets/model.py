"""The arrays that an asset consists of.

Frozen dataclasses of numpy arrays. Other packages take arrays, so they need not import this
package. All arrays are read-only. Data that a simulation does not need (images, finer meshes) are
read from files at their first use.

Coordinates of the head: millimetres, x toward the subject's left, y up, z toward the viewer; x = 0
is the mirror plane. Faces are counter-clockwise seen from outside.
Source: Kähler et al. 2003, section 5 (the face mesh with 2030 triangles, the plane with 154);
landmark numbering after Sagonas et al. 2013, "300 Faces in-the-Wild Challenge" (iBug 68 points).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..geometry.arrays import Floats32, Floats64, Integers32
from ..geometry.directions import unit_vectors
from ..geometry.read_only import make_read_only
from .data_files import Image, read_arrays, read_image
from .nostrils import lit_nostrils
from .topology import quarter

GLASSES_NAME = "glasses"  # the name of the part
MASK_NAME = "mask"  # the name of the part


class Segment(IntEnum):
    """Segments of a face in a picture, with the numbers of FaceSynthetics (Wood et al. 2021).

    Left and right are the subject's.
    """

    BACKGROUND = 0
    SKIN = 1
    NOSE = 2
    RIGHT_EYE = 3
    LEFT_EYE = 4
    RIGHT_BROW = 5
    LEFT_BROW = 6
    RIGHT_EAR = 7
    LEFT_EAR = 8
    MOUTH_INTERIOR = 9
    TOP_LIP = 10
    BOTTOM_LIP = 11
    NECK = 12
    HAIR = 13
    FACIAL_HAIR = 14
    CLOTHING = 15
    GLASSES = 16
    FACE_WEAR = 18
    IGNORE = 255


@dataclass(frozen=True)
class Eye:
    """One eyeball: a sphere that faces +z at rest.

    - name: "right" or "left" (the subject's).
    - centre: centre of rotation [mm], shape (3,), float64.
    - radius: radius of the sclera [mm].
    - iris_radius: radius of the iris [mm].
    """

    name: str
    centre: Floats64
    radius: float
    iris_radius: float

    def __post_init__(self) -> None:
        make_read_only(self)


@dataclass(frozen=True)
class Part:
    """A rigid object that is drawn but not simulated: an eyeball, a row of teeth, a shirt.

    - name: unique within the head.
    - vertices: rest positions [mm], shape (n, 3), float32.
    - normals: unit normals, shape (n, 3), float32.
    - faces: vertex indices, counter-clockwise from the visible side, shape (m, 3), int32.
    - colours: sRGB 0..1, shape (n, 3), float32.
    - bone: the bone that moves the part: "cranium", "mandible", "eye_left" or "eye_right". Parts
      with the bone "neck" do not move.
    - shine: specular strength, 0 (dull) to 1 (wet).
    - roots: for a part on the skin, the index of the root of each vertex, (n,), int32. The root is
      a vertex of the part, and its motion on the skin moves the vertex. None for other parts.
    - strand_radius: radius of the part's hairs [mm]; 0 for a part without hairs.
    - mandible_shares: for a part that stretches between both jaws, the weight of the mandible's
      motion at each vertex, 0 to 1, (n,), float32; None for other parts.
    - striation: for hair, (n, 7), float32: coordinates across and along strands [mm], the vector
      from root to tip [mm], the density, and the fray: 0 for hair that is combed smooth, to 1 for
      strands that end one by one at outlines, or to -1 for loose hair, whose locks end one by one
      at the hem. For locks of hair, (n, 5): the unit vector along the lock, half its width [mm]
      with the side of the vertex as its sign, and the opacity. None for other parts.
    """

    name: str
    vertices: Floats32
    normals: Floats32
    faces: Integers32
    colours: Floats32
    bone: str
    shine: float
    roots: Integers32 | None = None
    strand_radius: float = 0.0
    striation: Floats32 | None = None
    mandible_shares: Floats32 | None = None

    def __post_init__(self) -> None:
        make_read_only(self)

    @property
    def is_enclosed(self) -> bool:
        """Whether the part is inside the head, where no light from behind arrives."""
        if self.name in (GLASSES_NAME, MASK_NAME):
            return False
        return self.bone in ("cranium", "mandible", "eye_right", "eye_left")


@dataclass(frozen=True)
class Layer:
    """A table of controls above the muscles: action units, expressions, visemes, ARKit shapes.

    - title: heading under which a panel lists the controls.
    - source: name of the file in error messages.
    - rows: control name -> {name of a lower control, or one of NOT_SHARES: value}, as in the file;
      sim/layers.py explains them.
    """

    NOT_SHARES: ClassVar[tuple[str, ...]] = ("action", "pair", "mirror", "share_of", "at_least")
    title: str
    source: str
    rows: Mapping[str, Mapping[str, Any]]


@dataclass(frozen=True)
class Wrinkles:
    """Wrinkles of a face: a map of furrows, and the conditions under which they show.

    - map: (H, W, 4), uint8; row 0 is v = 1. The channels are the slopes of the skin's height along
      u and v (128 is flat), the depth of the furrow, and the blend of the amounts of both slots (0
      is the first, 255 the second).
    - steepest: slope for the byte 255 [mm per unit of texture coordinates].
    - across: for each vertex and slot, the direction at rest in which wrinkling skin shortens; its
      length is the readiness to wrinkle, zero for none; shape (V, 2, 3), float32.
    - resting: wrinkles of each vertex at rest, such as those of age, 0 to 1, shape (V,); (1,) for
      all.
    - folds: the part of `resting` that is anatomy, such as folds of lids, 0 to 1, shape (V,); (1,)
      for all. Folds also show in a face that is drawn without wrinkles.
    - lids: the fraction of skin that is shaded because lids are open, 0 to 1, shape (V,); (1,) for
      all.
    """

    map: Image
    steepest: float
    across: Floats32
    resting: Floats32 = field(default_factory=lambda: np.zeros(1, np.float32))
    folds: Floats32 = field(default_factory=lambda: np.zeros(1, np.float32))
    lids: Floats32 = field(default_factory=lambda: np.zeros(1, np.float32))

    def __post_init__(self) -> None:
        make_read_only(self)


class FineShape(NamedTuple):
    """Relief of a skin at rest that is finer than its triangles, as a map in the layout of `uv`."""

    slopes: Image
    """Slopes of its height along u and v, row 0 is v = 1, shape (H, W, 2), uint8; 128 is level."""
    steepest: float
    """Slope for the byte 255 [mm per unit of texture coordinates]."""


@dataclass(frozen=True)
class FineMesh:
    """The skin of a head with more triangles, at rest.

    vertices: [mm], shape (n, 3), float64; the first V are those of the head, bit for bit.
    faces: shape (4^level F, 3), int32; the children of face f replace it, side by side.
    normals: unit normals of the true form, shape (n, 3), float64.
    edges: for each cut into four, the ends of the halved edges, shape (E, 2), int32; new vertices
        have the order of these edges.
    """

    vertices: Floats64
    faces: Integers32
    normals: Floats64
    edges: tuple[Integers32, ...]

    def interpolate(self, values: Floats64 | Floats32) -> Floats64:
        """Interpolate values of the head's vertices (depth, weight, motion) at the fine vertices.

        values: shape (V,) or (V, k). Returns shape (n,) or (n, k).
        """
        carried = np.asarray(values, dtype=np.float64)
        for edges in self.edges:
            carried = np.concatenate([carried, carried[edges].mean(axis=1)])
        return carried


@dataclass(frozen=True)
class Head:
    """A head to simulate and draw.

    - vertices: rest positions of the skin [mm], shape (V, 3), float64.
    - faces: vertex indices, shape (F, 3), int32.
    - landmarks: vertex indices of the 68 iBug points, shape (68,), int32.
    - bone_depth: distance from the skin to the bone beneath [mm], shape (V,), float64.
    - mandible_weight: 0 = moves with the cranium, 1 = with the mandible, shape (V,), float64.
    - jaw_axis: centres of the right and the left condyle [mm], shape (2, 3), float64.
    - mirror: index of the mirror image of each vertex, shape (V,), int32.
    - anatomy: named anatomical points, name -> vertex index.
    - rings: named vertex rows of the left side, name -> vertex indices, shape (n,), int32; the same
      rows with _right for the right side. `eye_0_left` to `eye_4_left` run outward around the eye;
      `mouth_0_left` to `mouth_7_left` around half of the mouth, from the middle of the upper lip
      over the corner to the middle of the lower lip (2: where the lips meet, 6: border of the red);
      `ear_0_left` to `ear_4_left` from the root of the ear over its free edge (1) to the ridge
      around the concha, whose floor is `concha_left`; also `nostril_left`, `alar_crease_left`,
      `rim_left` (from the back of the head along the nape to the throat).
    - eyes: the right and the left eye.
    - parts: rigid parts that are drawn with the head.
    - uv: texture coordinates, 0..1, u to the subject's left and v up, shape (U, 2), float32; one
      piece without seams, so that U = V.
    - face_uv: indices of the texture coordinates of each face's corners, shape (F, 3), int32; the
      same indices as `faces`.
    - file: data file of the head. Maps and meshes for drawing lie beside this file, and are read at
      their first use; an unreadable file raises AssetError.
    - rig: the parsed rig file.
    - layers: action units, expressions, visemes, ARKit shapes, from the lowest up.
    """

    vertices: Floats64
    faces: Integers32
    landmarks: Integers32
    bone_depth: Floats64
    mandible_weight: Floats64
    jaw_axis: Floats64
    mirror: Integers32
    anatomy: Mapping[str, int]
    rings: Mapping[str, Integers32]
    eyes: tuple[Eye, ...]
    parts: tuple[Part, ...]
    uv: Floats32
    face_uv: Integers32
    file: Path
    rig: dict[str, Any]
    layers: tuple[Layer, ...]

    @property
    def expressions(self) -> Mapping[str, Mapping[str, float]]:
        """Each expression as a pose: values of action units and muscles, without texts."""
        rows = next((layer.rows for layer in self.layers if layer.title == "Expressions"), {})
        return {
            name: {key: float(value) for key, value in row.items() if key not in Layer.NOT_SHARES}
            for name, row in rows.items()
        }

    def file_beside(self, ending: str) -> Path:
        """Return the path of a file beside the head's data file; ending: the end of its name."""
        return self.file.with_name(self.file.stem + ending)

    @cached_property
    def albedo(self) -> Image:
        """The colour of the skin, sRGB, shape (H, W, 3), uint8; row 0 is v = 1."""
        return read_image(self.file_beside(".png"))

    @cached_property
    def wrinkles(self) -> Wrinkles:
        """The wrinkles of the skin; arrays are read-only."""
        arrays = read_arrays(self.file_beside("_wrinkles.npz"))
        return Wrinkles(arrays["map"], float(arrays["steepest"]), arrays["across"])

    @cached_property
    def segments(self) -> Image:
        """The segment of each texel, numbers of `Segment`, shape (H, W), uint8; row 0 is v = 1."""
        return read_image(self.file_beside("_segments.png"), mode="L")

    @cached_property
    def ambient_occlusion(self) -> Image:
        """Openness of the skin to light from all around, 255 = full; shape (H, W), uint8.

        Its texels are those of `albedo`.
        """
        occlusion = read_arrays(self.file_beside("_ambient_occlusion.npz"))["ambient_occlusion"]
        rims = [self.uv[self.rings[f"nostril_{side}"]] for side in ("left", "right")]
        return lit_nostrils(occlusion, rims)

    @cached_property
    def fine_shape(self) -> FineShape:
        """The relief of the skin that is finer than its triangles.

        Slopes fit gradients of u and v that are interpolated between vertices
        (`geometry.gradients`). On the neck they were solved, texel by texel by least squares, so
        that the drawn normal is the interpolated normal smoothed over 3.5 mm of skin.
        """
        arrays = read_arrays(self.file_beside("_fine_shape.npz"))
        slopes = np.cumsum(arrays["steps"], axis=0, dtype=np.uint8)  # steps compress better
        slopes.flags.writeable = False
        return FineShape(slopes, float(arrays["steepest"]))

    def finer(self, level: int) -> FineMesh:
        """The skin, with each triangle cut into 4 (level 1) or 16 (level 2); arrays are read-only.

        Every call reads the file. Raises ValueError for another level.
        """
        levels = (1, 2)
        if level not in levels:
            raise ValueError(
                f"level was {level!r}; allowed are 1 (4 triangles for each one) and 2 (16)"
            )
        arrays = read_arrays(self.file_beside("_finer.npz"))
        faces = self.faces
        count = len(self.vertices)
        edges = []
        for _ in range(level):
            cut = quarter(faces, count)
            faces = cut.faces
            count = count + len(cut.edges)
            edges.append(cut.edges)
        added = arrays["added_vertices"][: count - len(self.vertices)]
        normals = arrays["normals"][:count].astype(np.float64)
        normals = unit_vectors(normals)
        vertices = np.vstack([self.vertices, added])
        for array in (vertices, faces, normals, *edges):
            array.flags.writeable = False
        return FineMesh(vertices, faces, normals, tuple(edges))


@dataclass(frozen=True)
class Plane:
    """The triangulated plane of the paper's Figure 9.

    - vertices: rest positions [mm], shape (96, 3), float64, in the plane z = 0.
    - faces: vertex indices, counter-clockwise seen from +z, shape (154, 3), int32.
    """

    vertices: Floats64
    faces: Integers32
