"""Compare the program's outputs before and after a change of the code, file by file.

    python tests/goldens.py make out/before      with the old code
    python tests/goldens.py make out/after       with the new code
    python tests/goldens.py compare out/before out/after

Make both folders on one machine, because another processor rounds differently. The outputs are made
by users' commands, which stay valid when code moves between files. A picture may differ in a few
pixels by an invisible step, which is printed; if any other file differs in a byte, compare ends
with 1.
"""

import shutil
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from PIL import Image

COMMAND = Path(sys.executable).with_name("risorius")
DATA_FOLDER = Path(__file__).parents[1] / "assets" / "data"
SCRIPTS = ("face", "plane")
FORMATS = ("gltf", "usd", "pc2", "vtkhdf", "npz", "arkit")
SUFFIXES = {"gltf": "glb", "usd": "usdz", "vtkhdf": "vtkhdf", "arkit": "csv"}
POSES = ("joy", "anger", "fear", "disgust", "surprise", "sadness", "kiss", "AU43=1", "jawOpen=1")
CAMERAS = ("three-quarter", "profile", "top", "0,0,3")
LARGEST_STEP = 2  # steps of 255
FEW_PIXELS = 0.001  # share of all pixels


def commands() -> Iterator[tuple[str, list[str]]]:
    """Commands by name: 500 exported frames, every look, every file format, and 20 pictures."""
    yield "frames", ["export", "-o", "frames.npz", "--fps", "60"]
    for scene in SCRIPTS:
        for look in ("smooth", "paper"):
            name = f"{scene}_{look}"
            refined = ["--look", look, "--refined", "--fps", "5"]
            yield name, ["export", "--scene", scene, "-o", f"{name}.vtkhdf", *refined]
            yield f"{name}.png", ["capture", "--scene", scene, "--look", look, "-o", f"{name}.png"]
    for kind in FORMATS:
        output = f"clip_{kind}.{SUFFIXES.get(kind, kind)}"
        yield kind, ["export", "--set", "joy", "--fps", "10", "--as", kind, "-o", output]
    yield "obj", ["export", "--set", "joy", "--fps", "2", "--as", "obj", "-o", "obj"]
    for pose in POSES:
        yield pose, ["capture", "--set", pose, "--size", "640x480", "-o", f"{pose}.png"]
    for camera in CAMERAS:
        yield camera, ["capture", "--set", "joy", "--camera", camera, "-o", f"camera_{camera}.png"]
    yield "person", ["capture", "--set", "joy", "--head", "7", "-o", "person.png"]
    yield "anatomy", ["capture", "--set", "joy", "--anatomy", "muscles", "-o", "anatomy.png"]
    yield "compare", ["capture", "--compare", "none,paper", "-o", "compare.png"]
    passes = ["--passes", "depth,normal,triangle,splits,segmentation,landmarks"]
    yield "set", ["dataset", "--count", "3", "--seed", "4", *passes, "-o", "set"]


def make(folder: Path) -> bool:
    """Run every command in the folder; true if all succeeded."""
    folder.mkdir(parents=True)
    for each in sorted(DATA_FOLDER.iterdir()):
        shutil.copy(each, folder / f"head_{each.name}")
    failed = 0
    for name, words in commands():
        done = subprocess.run(
            [COMMAND, *words, "--quiet"], cwd=folder, capture_output=True, text=True, timeout=600
        )
        if done.returncode:
            failed += 1
            print(f"{name}: {done.stderr.strip()}")
    return not failed


def compare(before: Path, after: Path) -> bool:
    """Print differences; return True if a user would notice none of them."""
    names = {file.relative_to(root) for root in (before, after) for file in root.rglob("*.*")}
    same_all = True
    for name in sorted(each for each in names if not (before / each).is_dir()):
        old = before / name
        new = after / name
        if not (old.exists() and new.exists()):
            print(f"{name}: only {'before' if old.exists() else 'after'}")
            same_all = False
        elif contents(old) != contents(new):
            same = name.suffix == ".png" and looks_the_same(old, new)
            print(f"{name}: {'a few pixels differ a little' if same else 'DIFFERS'}")
            same_all = same_all and same
    print(f"{len(names)} files compared")
    return same_all


def contents(file: Path) -> object:
    """The bytes of a file; for a package the bytes of its members, without the times of writing."""
    if file.suffix != ".usdz":
        return file.read_bytes()
    with zipfile.ZipFile(file) as package:
        return [(name, package.read(name)) for name in package.namelist()]


def looks_the_same(old: Path, new: Path) -> bool:
    """Whether two pictures differ in so few pixels, or by so little, that nobody sees it."""
    first, second = (np.asarray(Image.open(each), dtype=np.int16) for each in (old, new))
    if first.shape != second.shape:
        return False
    step = np.abs(first - second).reshape(*first.shape[:2], -1).max(axis=2)
    return bool((step > LARGEST_STEP).mean() <= FEW_PIXELS)


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["make", folder]:
            sys.exit(not make(Path(folder)))
        case ["compare", before, after]:
            sys.exit(not compare(Path(before), Path(after)))
        case _:
            sys.exit(__doc__)
