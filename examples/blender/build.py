"""Build the add-on for Blender as one .zip with all that it needs: Extensions > Install from Disk.

    python examples/blender/build.py [linux-x64 | windows-x64 | macos-arm64] [FOLDER]

Wheels are bundled as they come from the package index, for Blender's own Python and numpy.
"""

import argparse
import shutil
import subprocess
import sys
import tempfile
import tomllib
import zipfile
from pathlib import Path

PASSED_OVER = shutil.ignore_patterns(".*", "__pycache__", "build", "dist", "out", "*.egg-info")
WHEELS_FOR = {  # by Blender's name of a platform: tags of wheels that run there
    "linux-x64": ("manylinux_2_28_x86_64", "manylinux_2_27_x86_64", "manylinux2014_x86_64"),
    "windows-x64": ("win_amd64",),
    "macos-arm64": ("macosx_12_0_arm64", "macosx_11_0_arm64"),
}


def collect_wheels(platform: str, folder: Path) -> list[Path]:
    """Put the wheels of risorius, numba and llvmlite into a folder.

    That of risorius is built from a copy: a build leaves files in its checkout, and those of an
    earlier one would get into the wheel.
    """
    copy = folder / "checkout"
    checkout = Path(__file__).parents[2]
    shutil.copytree(checkout, copy, ignore=PASSED_OVER)
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    wheels = ["--no-deps", "--wheel-dir", str(folder), str(copy)]
    subprocess.run([*pip, "wheel", *wheels], check=True)
    tags = [f"--platform={tag}" for tag in WHEELS_FOR[platform]]
    python = "3.11"  # of Blender 5.0
    chosen = ["--only-binary=:all:", f"--python-version={python}", *tags, "--dest", str(folder)]
    numpy = "numpy==1.26.4"  # of Blender 5.0
    subprocess.run([*pip, "download", *chosen, "numba>=0.62", numpy], check=True)
    return sorted(file for file in folder.glob("*.whl") if not file.name.startswith("numpy-"))


def main(platform: str, target: Path) -> Path:
    """Write the .zip; its manifest names the wheels, and the platform that they are for."""
    add_on = Path(__file__).parent / "risorius_refine"
    manifest = (add_on / "blender_manifest.toml").read_text(encoding="utf-8")
    about = tomllib.loads(manifest)
    file = target / f"{about['id']}-{about['version']}-{platform}.zip"
    with tempfile.TemporaryDirectory() as folder:
        wheels = collect_wheels(platform, Path(folder))
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
    command.add_argument("folder", nargs="?", type=Path, default=Path("."))
    given = command.parse_args()
    print(main(given.platform, given.folder))
