"""Load an asset by name: the built-in head or the paper's plane.

The head's numbers lie in `data/head.npz`, written by `python -m risorius.assets.build`; its rig and
the layers of controls above the muscles are text files, written by hand (`rigs/face.toml`,
`action_units.toml`, `expressions.toml`, `visemes.toml`).
"""

import tomllib
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, overload

import numpy as np
import numpy.typing as npt

from .model import AssetError, Eye, FineMesh, Head, Layer, Part, Picture, Plane, Wrinkles
from .plane import make_plane
from .subdivision import coarse_places, quarter

FOLDER = Path(__file__).parent
HEAD_FILE = FOLDER / "data" / "head.npz"
RIG_FILE = FOLDER / "rigs" / "face.toml"
LAYER_FILES = MappingProxyType(  # title -> file, from the lowest layer up
    {
        "Action units": FOLDER / "action_units.toml",
        "Expressions": FOLDER / "expressions.toml",
        "Visemes": FOLDER / "visemes.toml",
    }
)
FINER_LEVELS = (1, 2)
PROGRAM = "assets.build"  # makes the files


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


def load_head(
    head_file: Path = HEAD_FILE,
    *,
    rig_file: Path = RIG_FILE,
    layer_files: Mapping[str, Path] = LAYER_FILES,
) -> Head:
    """Read a head from its data file, its rig file and the files of its layers of controls.

    The picture of the skin lies beside the data file, as a PNG file of the same name; so do the
    files of its wrinkles (`_wrinkles.npz`), of the light on it (`_openness.npz`) and of the finer
    meshes (`_finer.npz`). All four are read only when they are asked for.

    Raises AssetError when the data file is missing or incomplete, or a text file is not TOML.
    """
    arrays = _read_arrays(head_file)
    try:
        return _assemble(arrays, head_file, _read_toml(rig_file), read_layers(layer_files))
    except KeyError as error:
        raise AssetError(
            f"{head_file} has no array {error}; rebuild it with 'python -m risorius.assets.build'"
        ) from error


def read_layers(files: Mapping[str, Path] = LAYER_FILES) -> tuple[Layer, ...]:
    """Read layers of controls, title -> file, from the lowest up; a missing file is no layer.

    Raises AssetError when a file is not TOML.
    """
    found = ((title, path, _read_toml(path)) for title, path in files.items())
    return tuple(Layer(title, path.name, rows) for title, path, rows in found if rows)


def read_finer(head: Head, level: int) -> FineMesh:
    """Put a finer mesh of the head together; see `Head.finer`."""
    if level not in FINER_LEVELS:
        raise ValueError(
            f"level was {level!r}; allowed are 1 (4 triangles for each one) and 2 (16)"
        )
    arrays = _made_for(head, head.finer_file, ("added_vertices", "normals"))
    faces, count = head.faces, len(head.vertices)
    for _ in range(level):
        cut = quarter(faces, count)
        faces, count = cut.faces, count + len(cut.edges)
    added = arrays["added_vertices"][: count - len(head.vertices)]
    normals = arrays["normals"][:count].astype(np.float64)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    vertices = np.vstack([head.vertices, added])
    fine = FineMesh(vertices, faces, *coarse_places(head.faces, faces), normals, head.faces)
    for array in (fine.vertices, fine.faces, fine.coarse_triangle, fine.barycentric, normals):
        array.flags.writeable = False
    return fine


def read_wrinkles(head: Head) -> Wrinkles:
    """Read where the head's skin wrinkles; see `Head.wrinkles`."""
    arrays = _made_for(head, head.wrinkles_file, ("map", "steepest", "across"))
    return Wrinkles(arrays["map"], float(arrays["steepest"]), arrays["across"])


def read_openness(head: Head) -> Picture:
    """Read how open the head's skin is to light; see `Head.openness`."""
    return _made_for(head, head.openness_file, ("openness",), "app.ambient")["openness"]


def _made_for(
    head: Head, path: Path, names: tuple[str, ...], program: str = PROGRAM
) -> dict[str, npt.NDArray[Any]]:
    """The arrays of a file that belongs to a head; AssetError if it belongs to another."""
    arrays = _read_arrays(path, program)
    if int(arrays.get("made_from", -1)) != fingerprint(head):
        raise AssetError(
            f"{path} was made for another head; rebuild it with 'python -m risorius.{program}'"
        )
    for name in names:
        if name not in arrays:
            raise AssetError(
                f"{path} has no array '{name}'; rebuild it with 'python -m risorius.{program}'"
            )
    return arrays


def fingerprint(head: Head) -> int:
    """A number that tells this head's mesh from any other: finer meshes fit one mesh only."""
    return zlib.crc32(head.faces.tobytes(), zlib.crc32(head.vertices.tobytes()))


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
    names = arrays["anatomy_names"].tolist()
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
        eyes=_eyes(arrays),
        parts=_parts(arrays),
        uv=arrays["uv"],
        face_uv=arrays["faces"],  # one piece without seams: a corner is a vertex
        albedo_file=head_file.with_suffix(".png"),
        wrinkles_file=head_file.with_name(f"{head_file.stem}_wrinkles.npz"),
        openness_file=head_file.with_name(f"{head_file.stem}_openness.npz"),
        finer_file=head_file.with_name(f"{head_file.stem}_finer.npz"),
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
        parts.append(
            Part(
                name=name,
                vertices=arrays["part_vertices"][vertices],
                normals=arrays["part_normals"][vertices],
                faces=arrays["part_faces"][faces],
                colours=arrays["part_colours"][vertices],
                bone=str(arrays["part_bones"][i]),
                shine=float(arrays["part_shine"][i]),
            )
        )
    return tuple(parts)


def _read_arrays(path: Path, program: str = PROGRAM) -> dict[str, npt.NDArray[Any]]:
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except FileNotFoundError as error:
        raise AssetError(
            f"the data file {path} is missing; build it with 'python -m risorius.{program}'"
        ) from error
    except Exception as error:  # zip, its compression and numpy have their own kinds each
        raise AssetError(
            f"the data file {path} is not a readable npz file ({error}); "
            f"rebuild it with 'python -m risorius.{program}'"
        ) from error
    for array in arrays.values():
        array.flags.writeable = False
    return arrays


def _read_toml(path: Path) -> dict[str, Any]:
    """A head without a rig or without a layer is still a head: no file means {}."""
    try:
        with path.open("rb") as file:
            return tomllib.load(file)
    except FileNotFoundError:
        return {}
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise AssetError(f"{path} is not readable as TOML: {error}") from error
