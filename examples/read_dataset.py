"""Read a data set for training: pictures, units, landmarks, as arrays; numpy and Pillow only.

    risorius dataset --count 1000 --passes depth,segmentation -o faces
    python examples/read_dataset.py faces

`Faces` is a data set for PyTorch, with a length and items by number: hand it to a DataLoader.
"""

import argparse
import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

UNITS = ("AU1", "AU2", "AU4", "AU6", "AU7", "AU10", "AU12", "AU14", "AU15", "AU17", "AU23", "AU24")


class Faces:
    """A set as `risorius dataset` makes it; each item is one sample."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        with (folder / "index.csv").open(encoding="utf-8", newline="") as file:
            self.rows = list(csv.DictReader(file))

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, number: int) -> dict[str, npt.NDArray[Any]]:
        """image (3, H, W) 0..1; units (12,) 0..1; pixels (70, 2) and visible (70,) of landmarks;
        classes (H, W), 255 = leave out, where the set has them.
        """
        row = self.rows[number]
        file = self.folder / row["id"]
        image = np.asarray(PIL.Image.open(file.with_suffix(".png")), np.float32) / 255.0
        labels = json.loads(file.with_suffix(".json").read_text("utf-8"))
        sample = {
            "image": image.transpose(2, 0, 1),
            "units": np.array([float(row[name]) for name in UNITS], np.float32),
            "pixels": np.array(labels["landmarks"]["pixels"], np.float32),
            "visible": np.array(labels["landmarks"]["visible"]),
        }
        classes = file.with_name(f"{file.name}_seg.png")
        if classes.exists():
            sample["classes"] = np.asarray(PIL.Image.open(classes))
        return sample

    def split(self, share: float = 0.2) -> tuple[list[int], list[int]]:
        """Numbers for training and for testing; nobody's face is in both, somebody's in each."""
        persons = sorted({int(row["person_number"]) for row in self.rows})
        count = min(max(round(share * len(persons)), 1), len(persons) - 1)  # of one person, none
        tested = set(persons[:count])
        is_tested = [int(row["person_number"]) in tested for row in self.rows]
        numbers = range(len(self))
        return [k for k in numbers if not is_tested[k]], [k for k in numbers if is_tested[k]]


if __name__ == "__main__":
    command = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    command.add_argument("folder", type=Path, help="of a set that `risorius dataset` made")
    faces = Faces(command.parse_args().folder)
    training, testing = faces.split()
    units = np.stack([faces[number]["units"] for number in range(len(faces))])
    print(f"{len(training)} samples to train with, {len(testing)} to test with")
    for name, values in zip(UNITS, units.T, strict=True):
        print(f"{name:5} in {np.mean(values >= 0.05):4.0%} of them, {values.mean():.2f} on average")
