"""Print the content of a training data set: samples per person, and how often units occur.

    risorius dataset --count 1000 --passes depth,segmentation -o faces
    python examples/read_dataset.py faces

`risorius.faces` reads the set; it needs numpy and Pillow only.
"""

import argparse
from pathlib import Path

import numpy as np

from risorius.faces import UNITS, Faces

if __name__ == "__main__":
    command = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    command.add_argument("folder", type=Path, help="of a set that `risorius dataset` made")
    try:
        faces = Faces(command.parse_args().folder)
    except FileNotFoundError as error:
        command.error(str(error))
    training, testing = faces.split()
    units = np.stack([faces[number]["units"] for number in range(len(faces))])
    print(f"{len(training)} samples to train with, {len(testing)} to test with")
    for name, values in zip(UNITS, units.T, strict=True):
        print(f"{name:5} in {np.mean(values >= 0.05):4.0%} of them, {values.mean():.2f} on average")
