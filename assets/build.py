"""Rebuild the head's data files and picture: `python -m risorius.assets.build`.

Seeds are fixed: one machine makes the same files each time. Other processors round differently in
the last digits, other versions of scipy may order a triangulation differently; the shipped files
are therefore part of the package, and a test compares them with a fresh build.

The ambient occlusion takes the simulation, which nothing here may import:
`python -m risorius.app.scenes.ambient_occlusion` bakes it for the head that is made here, and until
then it is baked wherever the head is shown.
"""

import argparse
import errno
import os
import signal
import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius.geometry.normals import vertex_normals

from .data_files import write_image
from .errors import AssetError
from .generator.bones import bone_depth, jaw_axis, mandible_weight
from .generator.dentition import LOWER_ARCH, UPPER_ARCH, gums, teeth
from .generator.eyeballs import IRIS_RADIUS, corner_flesh, eyeball
from .generator.finer import refine_skin
from .generator.form import EYE_CENTRE, EYE_RADIUS
from .generator.landmarks import anatomy, landmark_vertices
from .generator.lashes import THICKNESS, lashes, wet_edges
from .generator.oral import lower_cavity, tongue, upper_cavity
from .generator.painting import SIZE, paint_skin
from .generator.segments import paint_segments
from .generator.shirt import shirt
from .generator.skin import SkinMesh, build_half, mirrored
from .generator.solids import Solid
from .generator.tints import paint_tints
from .generator.unwrap import unwrap
from .generator.wrinkling import paint_wrinkles
from .loading import HEAD_FILE, load_head
from .model import Head
from .staging import StagingFolder

SMALLEST, LARGEST = 64, 8192  # [texels] of picture and wrinkles
HAIRS = {"lashes": THICKNESS}
MIRROR = np.array([-1.0, 1.0, 1.0])


def build_parts() -> list[tuple[str, str, float, Solid]]:
    """Return name, bone, shine and surface of every part."""
    left = eyeball()
    left.vertices = left.vertices + EYE_CENTRE
    right = left.mirrored()
    return [
        ("eyeball_right", "eye_right", 1.0, right),
        ("eyeball_left", "eye_left", 1.0, left),
        ("eye_corners", "cranium", 0.3, corner_flesh()),
        ("oral_cavity_upper", "cranium", 0.05, upper_cavity()),
        ("gums_upper", "cranium", 0.15, gums(UPPER_ARCH)),
        ("teeth_upper", "cranium", 0.45, teeth(UPPER_ARCH)),
        ("oral_cavity_lower", "mandible", 0.05, lower_cavity()),
        ("gums_lower", "mandible", 0.15, gums(LOWER_ARCH)),
        ("teeth_lower", "mandible", 0.35, teeth(LOWER_ARCH)),
        ("tongue", "mandible", 0.2, tongue()),
        ("wet_edges", "cranium", 0.8, wet_edges()),
        ("lashes", "cranium", 0.2, lashes()),
        ("shirt", "neck", 0.0, shirt()),
    ]


def part_arrays() -> dict[str, npt.NDArray[np.generic]]:
    """Return all parts as shared arrays, one after the other."""
    parts = build_parts()
    solids = [solid for *_, solid in parts]
    return {
        "part_names": np.array([name for name, *_ in parts]),
        "part_bones": np.array([bone for _, bone, *_ in parts]),
        "part_shine": np.array([shine for *_, shine, _ in parts]),
        "part_hair": np.array([HAIRS.get(name, 0.0) for name, *_ in parts]),
        "part_roots": np.concatenate([solid.roots for solid in solids]).astype(np.int32),
        "part_vertex_counts": np.array([len(solid.vertices) for solid in solids]),
        "part_face_counts": np.array([len(solid.faces) for solid in solids]),
        "part_vertices": np.vstack([solid.vertices for solid in solids]).astype(np.float32),
        "part_normals": np.vstack(
            [vertex_normals(solid.vertices, solid.faces) for solid in solids]
        ).astype(np.float32),
        "part_faces": np.vstack([solid.faces for solid in solids]).astype(np.int32),
        "part_colours": np.vstack([solid.colours for solid in solids]).astype(np.float32),
    }


def skin_arrays(skin: SkinMesh) -> dict[str, npt.NDArray[np.generic]]:
    """Return the skin, its names and its bone data as arrays."""
    named = anatomy(skin)
    arrays: dict[str, npt.NDArray[np.generic]] = {
        "vertices": skin.vertices,
        "faces": skin.faces,
        "landmarks": landmark_vertices(skin),
        "bone_depth": bone_depth(skin),
        "mandible_weight": mandible_weight(skin),
        "jaw_axis": jaw_axis(),
        "mirror": skin.mirror,
        "anatomy_names": np.array(list(named)),
        "anatomy_vertices": np.array(list(named.values()), dtype=np.int32),
        "eye_centres": np.array([EYE_CENTRE * MIRROR, EYE_CENTRE]),
        "eye_radii": np.array([[EYE_RADIUS, IRIS_RADIUS]] * 2),
    }
    rings: dict[str, npt.NDArray[np.int32]] = {}
    for name, row in skin.rings.items():
        left = np.array(row, dtype=np.int32)
        rings[f"{name}_left"], rings[f"{name}_right"] = left, skin.mirror[left]
    arrays["uv"] = unwrap(skin.vertices, skin.faces, skin.mirror, rings)
    return arrays | {f"ring_{name}": ring for name, ring in rings.items()}


def build_head() -> dict[str, npt.NDArray[np.generic]]:
    """Build everything that `data/head.npz` holds, array name -> array."""
    skin = mirrored(build_half())
    return skin_arrays(skin) | part_arrays()


def build_finer(head: Head) -> dict[str, npt.NDArray[np.generic]]:
    """Build everything that the file of the finer meshes holds, array name -> array.

    Places of the new vertices, level by level, and the normals of all; the rest is counting.
    """
    rings = {
        name.removesuffix("_left"): row.tolist()
        for name, row in head.rings.items()
        if name.endswith("_left")
    }
    added, normals = refine_skin(SkinMesh(head.vertices, head.faces, {}, rings, head.mirror))
    return {
        "added_vertices": added.astype(np.float32),
        "normals": normals.astype(np.float16),  # 0.03 degrees; full precision would double the file
        "made_from": np.array(head.fingerprint, dtype=np.uint32),
    }


def build_wrinkles(head: Head, size: int) -> dict[str, npt.NDArray[np.generic]]:
    """Build everything that the file of the wrinkles holds, array name -> array."""
    wrinkles = paint_wrinkles(head, size)
    return {
        "map": wrinkles.map,
        "steepest": np.array(wrinkles.steepest),
        "across": wrinkles.across,
        "relief": wrinkles.relief,
        "made_from": np.array(head.fingerprint, dtype=np.uint32),
    }


def main(arguments: list[str]) -> None:
    """Write data files and picture, to the place where `load` looks or to the one given.

    They are made in a folder beside it and moved when all are whole. OSError where that cannot be.
    Light that was baked for what lay there before is removed.
    """
    parser = argparse.ArgumentParser(
        prog="python -m risorius.assets.build", description=(__doc__ or "").splitlines()[0]
    )
    parser.add_argument("file", nargs="?", type=Path, default=HEAD_FILE, help="the data file")
    parser.add_argument("--size", type=_size, default=SIZE, help="of picture and wrinkles [texels]")
    given = parser.parse_args(arguments)
    if given.file.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder; name a file", str(given.file))
    given.file.parent.mkdir(parents=True, exist_ok=True)
    with StagingFolder(given.file.parent) as staging:
        _write(staging / given.file.name, given.size)
        for made in staging.iterdir():
            os.replace(made, given.file.parent / made.name)
    load_head(given.file).ambient_occlusion_file.unlink(missing_ok=True)


def _write(file: Path, size: int) -> None:
    """Build everything into `file` and the files that go with it."""
    _save(file, build_head())
    head = load_head(file)
    _save(head.finer_file, build_finer(head))
    _save(head.wrinkles_file, build_wrinkles(head, size))
    write_image(head.segments_file, paint_segments(head, size))
    write_image(head.albedo_file, paint_skin(head, size=size))
    _save(head.tints_file, paint_tints(head, size))


def _save(path: Path, arrays: dict[str, npt.NDArray[np.generic]]) -> None:
    with path.open("wb") as file:  # numpy would add an end to the name
        np.savez_compressed(file, allow_pickle=False, **arrays)


def _size(text: str) -> int:
    size = int(text) if text.isdecimal() else 0
    if not SMALLEST <= size <= LARGEST:
        raise argparse.ArgumentTypeError(f"'{text}' is no size; write {SMALLEST} to {LARGEST}")
    return size


def run(arguments: list[str]) -> None:
    """Run the program; what the user can mend is told in one line, with exit code 2."""
    try:
        main(arguments)
    except (OSError, AssetError) as error:
        parts = [str(error)]
        if isinstance(error, OSError) and error.strerror:
            parts = [*([str(error.filename)] if error.filename else []), error.strerror]
        print(f"assets.build: {': '.join(parts)}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("assets.build: stopped", file=sys.stderr)
        sys.exit(128 + signal.SIGINT)


if __name__ == "__main__":
    run(sys.argv[1:])
