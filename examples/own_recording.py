"""A recorded face in a program of your own: from a file to the vertices of every frame.

    python examples/own_recording.py take.csv [vertices.npy]

Reads what `risorius replay` reads, and writes an array (T, V, 3) of a frame at 60 Hz each [mm], in
the order of `risorius.assets.load("head").vertices`.
"""

import argparse
from pathlib import Path

import numpy as np
import numpy.typing as npt

from risorius.app.recordings import calibration_for, load_mapping, read_take
from risorius.app.scenes import FaceScene

STEP = 1 / 60  # [s]


def main(recording: Path) -> npt.NDArray[np.float64]:
    """Play a recording on the built-in head."""
    take = read_take(recording)
    calibration = calibration_for(take)  # a face at rest is at 0; neutral="first:1" is another way
    mapping = load_mapping(None)  # or the file of your own table
    scene = FaceScene()
    curves = mapping.controls(calibration.apply(take.channels))
    curves = {name: values for name, values in curves.items() if name in scene.limits}
    frames = []
    for time in np.arange(0.0, take.duration + STEP, STEP):
        scene.pose({name: float(np.interp(time, take.times, curves[name])) for name in curves})
        scene.step(STEP)
        frames.append(scene.positions.copy())  # a view, rewritten by every step
    return np.stack(frames)


if __name__ == "__main__":
    command = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    command.add_argument("recording", type=Path)
    command.add_argument("file", type=Path, nargs="?", default=Path("vertices.npy"))
    given = command.parse_args()
    vertices = main(given.recording)
    np.save(given.file, vertices)
    print(f"{len(vertices)} frames of {vertices.shape[1]} vertices: {given.file}")
