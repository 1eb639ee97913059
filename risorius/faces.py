"""Read a data set for training: pictures, units, landmarks, as arrays.

    from risorius.faces import Faces

`Faces` is a data set for PyTorch's DataLoader, with a length and items by number. This file only
needs numpy and Pillow, and no other part of Risorius: it may be copied to a training machine.
"""

from __future__ import annotations

import csv
import io
import json
import os
import tarfile
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import PIL.Image

UNITS = ("AU1", "AU2", "AU4", "AU6", "AU7", "AU10", "AU12", "AU14", "AU15", "AU17", "AU23", "AU24")


class Faces:
    """A data set of `risorius dataset`, in single files or shards; each item is a sample."""

    def __init__(self, folder: str | os.PathLike[str]) -> None:
        """folder: the set's folder. Raises FileNotFoundError if it has no index."""
        self.folder = Path(folder)
        index = self.folder / "index.csv"
        if not index.is_file():
            made_by = "`risorius dataset` writes it when all samples are made"
            raise FileNotFoundError(f"{index}: no such index of a data set; {made_by}")
        with index.open(encoding="utf-8", newline="") as file:
            self.rows = list(csv.DictReader(file))

    def __len__(self) -> int:
        return len(self.rows)

    def __getitem__(self, number: int) -> dict[str, npt.NDArray[Any]]:
        """Return a sample as a dictionary of arrays.

        - `image`: (3, H, W), 0..1
        - `units`: action units, (12,), 0..1
        - `pixels` and `visible`: landmarks, (70, 2) and (70,)
        - `classes`: (H, W), 255 = ignore, if the set has them
        """
        files = self.files(number)
        labels = json.loads(files["json"])
        sample = {
            "image": _picture(files["png"]).astype(np.float32).transpose(2, 0, 1) / 255.0,
            "units": np.array([float(self.rows[number][name]) for name in UNITS], np.float32),
            "pixels": np.array(labels["landmarks"]["pixels"], np.float32),
            "visible": np.array(labels["landmarks"]["visible"]),
        }
        if "seg.png" in files:
            sample["classes"] = _picture(files["seg.png"])
        return sample

    def files(self, number: int) -> dict[str, bytes]:
        """The content of the files of a sample, by "png", "json", "seg.png", "ldmks.txt", "exr"."""
        row = self.rows[number]
        if row.get("shard"):
            with (self.folder / row["shard"]).open("rb") as file:
                file.seek(int(row["offset"]))
                part = io.BytesIO(file.read(int(row["bytes"])))
            return dict(_members(part))
        names = {
            kind: self.folder / f"{row['id']}{mark}{kind}"
            for mark, kinds in ((".", ("png", "json", "exr")), ("_", ("seg.png", "ldmks.txt")))
            for kind in kinds
        }
        return {kind: path.read_bytes() for kind, path in names.items() if path.exists()}

    def split(self, share: float = 0.2) -> tuple[list[int], list[int]]:
        """Numbers of samples for training and testing: two sets without a common person."""
        persons = sorted({int(row["person_number"]) for row in self.rows})
        # With one person, no such split exists.
        count = min(max(round(share * len(persons)), 1), len(persons) - 1)
        tested_persons = set(persons[:count])
        trained: list[int] = []
        tested: list[int] = []
        for number, row in enumerate(self.rows):
            is_tested = int(row["person_number"]) in tested_persons
            (tested if is_tested else trained).append(number)
        return trained, tested


def _members(part: io.BytesIO) -> list[tuple[str, bytes]]:
    """The files in a part of a tar file; a key is the name's part after the first dot."""
    found = []
    with tarfile.open(fileobj=part, mode="r:") as tar:
        for member in tar:
            content = tar.extractfile(member)
            if content is not None:
                found.append((member.name.partition(".")[2], content.read()))
    return found


def _picture(content: bytes) -> npt.NDArray[np.uint8]:
    return np.asarray(PIL.Image.open(io.BytesIO(content)))
