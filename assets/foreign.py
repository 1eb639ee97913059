"""The part of reading a PLY, STL, OFF or GLB file that trimesh does, in a process of its own.

A header of a few bytes may claim a billion vertices, and a picture of a few bytes may unfold to
gigabytes. So nothing of somebody else's file is read beside our data: memory is limited there,
where the system can do that (not on Windows), and nobody waits for it longer than a minute.
"""

import contextlib
import io
import logging
import os
import re
import subprocess
import sys
import warnings
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import AssetError
from .pictures import shrunk
from .user_files import plain_text

PACKED = re.compile(  # in which ways trimesh reads no positions
    rb'"extensionsRequired"[^]]*"(KHR_draco_mesh_compression|EXT_meshopt_compression)"'
)
MOST_MEMORY = 4 << 30  # [bytes] of addresses; the largest mesh that is allowed takes a quarter
MOST_SECONDS = 60.0  # such a mesh takes 3
_BLANK_LINES = re.compile(rb"\n\s*\n")
Arrays = dict[str, npt.NDArray[Any]]


def read_arrays_apart(content: bytes, suffix: str) -> Arrays:
    """What `arrays_in` finds, found by another process; AssetError where that fails.

    content: of the file. suffix: the end of its name, "ply", "stl", "off" or "glb".
    """
    if packed := PACKED.search(content) if suffix == "glb" else None:
        raise AssetError(f"is compressed ({packed[1].decode()}); export it without compression")
    path = os.pathsep.join(filter(None, sys.path))
    try:
        done = subprocess.run(
            [sys.executable, "-P", "-c", f"from {__name__} import answer; answer()", suffix],
            input=_plain(content, suffix),
            capture_output=True,
            timeout=MOST_SECONDS,
            env={**os.environ, "PYTHONPATH": path, "OPENBLAS_NUM_THREADS": "1"},
            check=False,
        )
        reason = " ".join(done.stderr.decode("utf-8", "replace").split())[-200:]
    except subprocess.TimeoutExpired:
        done, reason = None, f"it takes more than {MOST_SECONDS:g} s to read"
    if done is None or done.returncode:
        raise AssetError(
            f"broken, or not what its name says ({reason or 'its reader was stopped'}); open it in "
            "a modelling program, triangulate it and save it anew"
        )
    with np.load(io.BytesIO(done.stdout), allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def arrays_in(content: bytes, suffix: str) -> Arrays:
    """The arrays of a mesh file, as far as it has them.

    vertices (V, 3), faces (F, 3); colours of vertices (V, 3); of GLB files uv (V, 2), and which
    picture each triangle has, -1 for none, (F,); the pictures themselves are picture_0, ...
    """
    import trimesh

    # numpy's way to say that a number is none, after which it would read no further
    warnings.filterwarnings("error", category=DeprecationWarning, message="string or file")
    scene: Any = trimesh.load_scene(
        io.BytesIO(content),
        file_type=suffix,
        process=False,
        maintain_order=True,
        skip_materials=suffix != "glb",
        fix_texture=False,
    )
    pieces: list[Any] = [each for each in scene.dump() if hasattr(each, "faces")]
    starts = np.cumsum([0, *(len(each.vertices) for each in pieces)])
    faces = [each.faces.reshape(-1, 3) + start for each, start in zip(pieces, starts, strict=False)]
    arrays = {
        "vertices": np.vstack([np.zeros((0, 3)), *(each.vertices for each in pieces)]),
        "faces": np.vstack([np.zeros((0, 3), np.int64), *faces]),
    }
    if pieces and all(each.visual.kind == "vertex" for each in pieces):
        colours = [np.asarray(each.visual.vertex_colors)[:, :3] for each in pieces]
        arrays["colours"] = np.vstack(colours).astype(np.uint8)
    return arrays | (_painted(pieces) if suffix == "glb" else {})


def _painted(pieces: list[Any]) -> Arrays:
    """Where the pieces of a GLB file lie in which pictures; {} where they are not painted."""
    uv, pictures, number = list[Any](), dict[int, npt.NDArray[np.uint8]](), list[Any]()
    for each in pieces:
        found = getattr(each.visual, "uv", None)
        picture = getattr(getattr(each.visual, "material", None), "baseColorTexture", None)
        at, places = -1, np.zeros((len(each.vertices), 2))
        if picture is not None and found is not None and len(found) == len(each.vertices):
            image = shrunk(picture)
            key = hash(image.tobytes())  # each piece has a copy of its own
            pictures.setdefault(key, image)
            at, places = [*pictures].index(key), found[:, :2]
        uv.append(places)
        number.append(np.full(len(each.faces), at))
    if not pictures:
        return {}
    images = {f"picture_{n}": image for n, image in enumerate(pictures.values())}
    return {"uv": np.vstack(uv), "picture": np.concatenate(number), **images}


def answer() -> None:
    """Write the arrays of the file that comes in, or say why there are none."""
    logging.disable()
    with contextlib.suppress(ImportError):  # Windows
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    output, sys.stdout = sys.stdout.buffer, sys.stderr
    warnings.simplefilter("ignore")
    try:
        with np.errstate(all="ignore"):
            arrays = arrays_in(sys.stdin.buffer.read(), sys.argv[1])
        np.savez(output, **arrays)  # type: ignore[arg-type]
    except Exception as error:  # every reader of trimesh has its own kinds
        sys.exit(f"{type(error).__name__}: {error}")


def _plain(content: bytes, suffix: str) -> bytes:
    """The same with its text as ASCII and without blank lines, over which trimesh would stumble."""
    if suffix == "ply":
        head, mark, body = content.partition(b"end_header")
        return plain_text(head) + mark + (body if b"binary" in head else _lines(body))
    is_text = suffix != "glb" and b"\0" not in content  # else STL of bytes
    return _lines(content) if is_text else content


def _lines(text: bytes) -> bytes:
    return _BLANK_LINES.sub(b"\n", plain_text(text))
