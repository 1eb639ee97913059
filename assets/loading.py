"""Load an asset by name: the built-in head or the paper's plane.

`data/head.npz` has the head's numbers (docs/head.md names their origin). Its rig and the layers of
controls above the muscles are text files, written by hand (`rigs/face.toml`, `action_units.toml`,
`expressions.toml`, `visemes.toml`, `arkit.toml`), and so are the plain words for controls
(`words.toml`).
"""

import functools
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from .data_files import read_arrays, read_toml
from .errors import AssetError
from .model import Eye, Head, Layer, Part, Plane
from .sheets import CELL_SIZE, SHEET_COLUMNS, SHEET_ROWS, make_grid

ASSET_FOLDER = Path(__file__).parent
HEAD_FILE = ASSET_FOLDER / "data" / "head.npz"
RIG_FILE = ASSET_FOLDER / "rigs" / "face.toml"
WORDS_FILE = ASSET_FOLDER / "words.toml"
ARRAY_NAMES = (  # arrays of the data file that become fields of a head unchanged
    "vertices faces landmarks bone_depth mandible_weight jaw_axis mirror uv".split()
)
LAYER_FILES = MappingProxyType(  # title -> file, from the lowest layer up
    {
        "Action units": ASSET_FOLDER / "action_units.toml",
        "Expressions": ASSET_FOLDER / "expressions.toml",
        "Visemes": ASSET_FOLDER / "visemes.toml",
        "ARKit shapes": ASSET_FOLDER / "arkit.toml",
    }
)


@overload
def load(name: Literal["head"]) -> Head: ...
@overload
def load(name: Literal["plane"]) -> Plane: ...
@overload
def load(name: str) -> Head | Plane: ...
@functools.cache
def load(name: str) -> Head | Plane:
    """Load the asset called `name` ("head" or "plane") once; its content is read-only.

    Raises AssetError for an unknown name, and for a missing or broken file.
    """
    if name == "head":
        return load_head()
    if name == "plane":
        return Plane(*make_grid(SHEET_COLUMNS, SHEET_ROWS, CELL_SIZE))
    others = "a mesh file is read by `read_mesh`, a head fitted by `fitting.fit_head`"
    raise AssetError(f"no asset is called {name!r}; available: head, plane; {others}")


def load_head(head_file: Path = HEAD_FILE) -> Head:
    """Read a head from its data file, and its rig and layers of controls from text files.

    Raises AssetError when one of these is missing or broken.
    """
    arrays = read_arrays(head_file)
    names = arrays["anatomy_names"].tolist()
    rings = [name for name in arrays if name.startswith("ring_")]
    eyes = []
    for number, side in enumerate(("right", "left")):
        radius, iris_radius = arrays["eye_radii"][number].tolist()
        eyes.append(Eye(side, arrays["eye_centres"][number], radius, iris_radius))
    return Head(
        **{name: arrays[name] for name in ARRAY_NAMES},
        anatomy=dict(zip(names, arrays["anatomy_vertices"].tolist(), strict=True)),
        rings={name.removeprefix("ring_"): arrays[name] for name in rings},
        eyes=tuple(eyes),
        parts=_parts(arrays),
        face_uv=arrays["faces"],  # one piece without seams: a corner is a vertex
        file=head_file,
        rig=read_toml(RIG_FILE),
        layers=tuple(
            Layer(title, path.name, read_toml(path)) for title, path in LAYER_FILES.items()
        ),
    )


def read_words() -> Mapping[str, Any]:
    """Plain words for controls: tables of `names` and `synonyms`, the `order` of groups."""
    return read_toml(WORDS_FILE)


def _parts(arrays: dict[str, npt.NDArray[Any]]) -> tuple[Part, ...]:
    """Read parts from shared arrays, in which they follow each other: npz entries are slow."""
    vertex_ends = np.cumsum(arrays["part_vertex_counts"])[:-1]
    face_ends = np.cumsum(arrays["part_face_counts"])[:-1]
    vertices = np.split(arrays["part_vertices"], vertex_ends)
    normals = np.split(arrays["part_normals"], vertex_ends)
    colours = np.split(arrays["part_colours"], vertex_ends)
    roots = np.split(arrays["part_roots"], vertex_ends)
    shares = np.split(arrays["part_mandible_shares"], vertex_ends)
    faces = np.split(arrays["part_faces"], face_ends)
    return tuple(
        Part(
            name=name,
            vertices=vertices[i],
            normals=normals[i],
            faces=faces[i],
            colours=colours[i],
            bone=str(arrays["part_bones"][i]),
            shine=float(arrays["part_shine"][i]),
            roots=roots[i] if roots[i].min() >= 0 else None,
            strand_radius=float(arrays["part_hair"][i]),
            mandible_shares=shares[i] if shares[i].any() else None,
        )
        for i, name in enumerate(arrays["part_names"].tolist())
    )
