"""Build the add-on for Blender as one complete .zip for Extensions > Install from Disk.

    python examples/blender/build.py [linux-x64 | windows-x64 | macos-arm64] [FOLDER]
    python examples/blender/build.py --blender 5.0 linux-x64

Wheels from the package index are bundled unchanged, for Blender's own Python and numpy. So each
.zip is for one version of Blender, 5.2 by default, and one platform.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path
from typing import NamedTuple

PASSED_OVER = shutil.ignore_patterns(".*", "__pycache__", "build", "dist", "out", "*.egg-info")


class Blender(NamedTuple):
    """Data of a version of Blender for wheels and the manifest."""

    python: str
    numpy: str
    first: str
    """The first version that the .zip supports."""
    beyond: str
    """The first later version that the .zip does not support."""


BLENDER_VERSIONS = {
    "5.0": Blender("3.11", "numpy==1.26.4", "5.0.0", "5.1.0"),
    "5.2": Blender("3.13", "numpy==2.3.*", "5.2.0", "5.3.0"),
}
WHEELS_FOR = {  # Blender's name of a platform -> wheel tags of this platform
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_12_0_arm64", "macosx_11_0_arm64"),
}


def collect_wheels(blender: Blender, platform: str, folder: Path) -> list[Path]:
    """Put the wheels of risorius, numba and llvmlite into a folder.

    The wheel of risorius is built from a copy: a build leaves files in its checkout, and files of
    an earlier build would get into the wheel.
    """
    copy = folder / "checkout"
    checkout = Path(__file__).parents[2]
    shutil.copytree(checkout, copy, ignore=PASSED_OVER)
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    wheels = ["--no-deps", "--wheel-dir", str(folder), str(copy)]
    subprocess.run([*pip, "wheel", *wheels], check=True)
    tags = [f"--platform={tag}" for tag in WHEELS_FOR[platform]]
    tags.append(f"--python-version={blender.python}")
    chosen = ["--only-binary=:all:", *tags, "--dest", str(folder)]
    subprocess.run([*pip, "download", *chosen, "numba>=0.62", blender.numpy], check=True)
    return sorted(file for file in folder.glob("*.whl") if not file.name.startswith("numpy-"))


def main(version: str, platform: str, target: Path) -> Path:
    """Write the .zip; its manifest names the wheels, the platform and the version of Blender."""
    blender = BLENDER_VERSIONS[version]
    add_on = Path(__file__).parent / "risorius_refine"
    manifest = (add_on / "blender_manifest.toml").read_text(encoding="utf-8")
    about = tomllib.loads(manifest)
    for key, value in (("min", blender.first), ("max", blender.beyond)):
        stated = f'blender_version_{key} = "{about[f"blender_version_{key}"]}"'
        manifest = manifest.replace(stated, f'blender_version_{key} = "{value}"')
    file = target / f"{about['id']}-{about['version']}-blender{version}-{platform}.zip"
    target.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        wheels = collect_wheels(blender, platform, Path(folder))
        names = "".join(f'    "./wheels/{wheel.name}",\n' for wheel in wheels)
        lines = f'platforms = ["{platform}"]\nwheels = [\n{names}]\n\n'
        part = file.with_suffix(".part")
        with zipfile.ZipFile(part, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.write(add_on / "__init__.py", "__init__.py")
            permissions = manifest.index("[permissions]")  # keys come before tables
            whole = manifest[:permissions] + lines + manifest[permissions:]
            archive.writestr("blender_manifest.toml", whole)
            for wheel in wheels:
                archive.write(wheel, f"wheels/{wheel.name}")
        part.replace(file)
    return file


if __name__ == "__main__":
    command = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    command.add_argument("platform", nargs="?", choices=WHEELS_FOR, default="linux-x64")
    command.add_argument("--blender", choices=BLENDER_VERSIONS, default="5.2")
    command.add_argument("folder", nargs="?", type=Path, default=Path("."))
    given = command.parse_args()
    print(main(given.blender, given.platform, given.folder))
