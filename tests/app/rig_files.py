"""A user's typical head: an OBJ file with eyes, teeth, tongue, lashes, hair and shirt."""

import json
from pathlib import Path

import numpy as np
import PIL.Image

from risorius.app.scenes import FaceScene

CENTIMETRES_PER_MILLIMETRE = 0.1
LIBRARY_NAME = "Farben für 頭.mtl"
PICTURE_NAME = "Haut für 頭.png"
FIRST_PARTS = ("eyeball_left", "tongue")  # parts before the skin in the file


def write_whole_head(folder: Path, scene: FaceScene) -> tuple[Path, Path, dict[str, slice]]:
    """Write the built-in head with its parts, in centimetres; return each part's vertices.

    The skin has texture coordinates, normals and a material with a picture. Of the locks of hair
    only a fortieth is written, because each of them is a piece of the file.
    """
    scene.reset()
    parts = {part.name: part for part in scene.parts if part.name != "wet_edges"}
    names = [*FIRST_PARTS, "skin", *(name for name in parts if name not in FIRST_PARTS)]
    lines = [f"mtllib {LIBRARY_NAME}"]
    places: dict[str, slice] = {}
    count = 0
    for name in names:
        is_skin = name == "skin"
        points = scene.rest_positions if is_skin else np.float64(parts[name].vertices)
        faces = scene.faces if is_skin else parts[name].faces
        if name == "hair_locks":
            points = points[: len(points) // 40]
            faces = faces[(faces < len(points)).all(axis=1)]
        lines.append(f"g {name}\nusemtl {'skin' if is_skin else 'parts'}")
        lines += [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in points * CENTIMETRES_PER_MILLIMETRE]
        if is_skin:
            assert scene.skin.uv is not None and scene.skin.face_uv is not None
            lines += [f"vt {u:.6f} {v:.6f}" for u, v in scene.skin.uv]
            for corners, uv in zip(faces + 1 + count, scene.skin.face_uv + 1, strict=True):
                pairs = zip(corners, uv, strict=True)
                lines.append("f " + " ".join(f"{vertex}/{place}" for vertex, place in pairs))
        else:
            lines += [f"f {a} {b} {c}" for a, b, c in faces + 1 + count]
        places[name] = slice(count, count + len(points))
        count += len(points)
    mesh = folder / "whole.obj"
    mesh.write_text("\n".join(lines), encoding="utf-8")
    picture = np.full((8, 8, 3), (200, 150, 130), np.uint8)
    PIL.Image.fromarray(picture).save(folder / PICTURE_NAME)
    library = f"newmtl skin\nKd 1 1 1\nmap_Kd {PICTURE_NAME}\nnewmtl parts\nKd 0.2 0.4 0.8\n"
    (folder / LIBRARY_NAME).write_text(library, encoding="utf-8")
    landmarks = folder / "whole.json"
    numbers = np.asarray(scene.landmarks) + places["skin"].start
    landmarks.write_text(json.dumps({"landmarks": numbers.tolist()}))
    return mesh, landmarks, places
