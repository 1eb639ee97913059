"""Load an asset by name: the built-in head or the paper's plane.

The head's numbers lie in `data/head.npz` (docs/head.md says where they are from); its rig and
the layers of controls above the muscles are text files, written by hand (`rigs/face.toml`,
`action_units.toml`, `expressions.toml`, `visemes.toml`, `arkit.toml`), and so are the plain words
for controls (`words.toml`).
"""

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from .data_files import read_arrays, read_toml
from .errors import AssetError
from .eyeballs import with_irises
from .model import Eye, Head, Layer, Part, Plane
from .sheets import make_plane

FOLDER = Path(__file__).parent
HEAD_FILE = FOLDER / "data" / "head.npz"
RIG_FILE = FOLDER / "rigs" / "face.toml"
WORDS_FILE = FOLDER / "words.toml"
LAYER_FILES = MappingProxyType(  # title -> file, from the lowest layer up
    {
        "Action units": FOLDER / "action_units.toml",
        "Expressions": FOLDER / "expressions.toml",
        "Visemes": FOLDER / "visemes.toml",
        "ARKit shapes": FOLDER / "arkit.toml",
    }
)


def available() -> tuple[str, ...]:
    """Return the names that `load` knows."""
    return ("head", "plane")


@overload
def load(name: Literal["head"]) -> Head: ...
@overload
def load(name: Literal["plane"]) -> Plane: ...
@overload
def load(name: str) -> Head | Plane: ...
def load(name: str) -> Head | Plane:
    """Load the asset called `name` ("head" or "plane"); its arrays are read-only.

    Raises AssetError for an unknown name and for a missing or broken file.
    """
    if name == "head":
        return load_head()
    if name == "plane":
        return make_plane()
    raise AssetError(f"no asset is called {name!r}; available: {', '.join(available())}")


def load_head(head_file: Path = HEAD_FILE) -> Head:
    """Read a head from its data file, and its rig and layers of controls from text files.

    The image of the skin lies beside the data file, as a PNG file of the same name; so do the files
    of its tones (`_tints.npz`), of its wrinkles (`_wrinkles.npz`), of its classes
    (`_segments.png`), of the light on it (`_ambient_occlusion.npz`), of its fine shape
    (`_fine_shape.npz`), of the finer meshes (`_finer.npz`) and of how people differ (`_modes.npz`).
    All eight are read only when they are asked for.

    Raises AssetError when the data file is missing or incomplete, or a text file is not TOML.
    """
    arrays = read_arrays(head_file)
    try:
        return _assemble(arrays, head_file, read_toml(RIG_FILE), _read_layers())
    except KeyError as error:
        raise AssetError(f"{head_file} has no array {error}; install risorius again") from error


def _read_layers() -> tuple[Layer, ...]:
    """Layers of controls from the lowest up; a missing file is no layer."""
    found = ((title, path, read_toml(path)) for title, path in LAYER_FILES.items())
    return tuple(Layer(title, path.name, rows) for title, path, rows in found if rows)


def read_words() -> Mapping[str, Any]:
    """Plain words for controls: tables of `names` and `synonyms`, the `order` of groups.

    Raises AssetError when the file is not TOML.
    """
    return read_toml(WORDS_FILE)


def _assemble(
    arrays: dict[str, npt.NDArray[Any]],
    head_file: Path,
    rig: dict[str, Any],
    layers: tuple[Layer, ...],
) -> Head:
    rings = {
        name.removeprefix("ring_"): array
        for name, array in arrays.items()
        if name.startswith("ring_")
    }
    names, eyes = arrays["anatomy_names"].tolist(), _eyes(arrays)
    return Head(
        vertices=arrays["vertices"],
        faces=arrays["faces"],
        landmarks=arrays["landmarks"],
        bone_depth=arrays["bone_depth"],
        mandible_weight=arrays["mandible_weight"],
        jaw_axis=arrays["jaw_axis"],
        mirror=arrays["mirror"],
        anatomy=dict(zip(names, arrays["anatomy_vertices"].tolist(), strict=True)),
        rings=rings,
        eyes=eyes,
        parts=with_irises(_parts(arrays), eyes),
        uv=arrays["uv"],
        face_uv=arrays["faces"],  # one piece without seams: a corner is a vertex
        albedo_file=head_file.with_suffix(".png"),
        tints_file=head_file.with_name(f"{head_file.stem}_tints.npz"),
        wrinkles_file=head_file.with_name(f"{head_file.stem}_wrinkles.npz"),
        segments_file=head_file.with_name(f"{head_file.stem}_segments.png"),
        ambient_occlusion_file=head_file.with_name(f"{head_file.stem}_ambient_occlusion.npz"),
        fine_shape_file=head_file.with_name(f"{head_file.stem}_fine_shape.npz"),
        finer_file=head_file.with_name(f"{head_file.stem}_finer.npz"),
        modes_file=head_file.with_name(f"{head_file.stem}_modes.npz"),
        rig=rig,
        layers=layers,
    )


def _eyes(arrays: dict[str, npt.NDArray[Any]]) -> tuple[Eye, ...]:
    centres, radii = arrays["eye_centres"], arrays["eye_radii"]
    return tuple(
        Eye(name, centres[i], float(radii[i, 0]), float(radii[i, 1]))
        for i, name in enumerate(("right", "left"))
    )


def _parts(arrays: dict[str, npt.NDArray[Any]]) -> tuple[Part, ...]:
    """Parts lie one after the other in shared arrays: an npz entry costs more than its numbers."""
    vertex_ends = np.cumsum(arrays["part_vertex_counts"])
    face_ends = np.cumsum(arrays["part_face_counts"])
    parts = []
    for i, name in enumerate(arrays["part_names"].tolist()):
        vertices = slice(vertex_ends[i] - arrays["part_vertex_counts"][i], vertex_ends[i])
        faces = slice(face_ends[i] - arrays["part_face_counts"][i], face_ends[i])
        roots = arrays["part_roots"][vertices]
        parts.append(
            Part(
                name=name,
                vertices=arrays["part_vertices"][vertices],
                normals=arrays["part_normals"][vertices],
                faces=arrays["part_faces"][faces],
                colours=arrays["part_colours"][vertices],
                bone=str(arrays["part_bones"][i]),
                shine=float(arrays["part_shine"][i]),
                roots=roots if roots.min() >= 0 else None,
                strand_radius=float(arrays["part_hair"][i]),
            )
        )
    return tuple(parts)
