"""coco.json: the landmarks of a set in the format of COCO's keypoints.

Source: the data format of COCO, keypoint detection: x, y, v for each keypoint, v = 0 not labelled
(here: beside the picture), 1 labelled but hidden, 2 visible. The middle of the first pixel is
(0.5, 0.5), as in all files of a set.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

LINES = (  # first and last landmark, of 68, and whether the last meets the first
    ("jaw", 0, 16, False),
    ("right_brow", 17, 21, False),
    ("left_brow", 22, 26, False),
    ("nose_bridge", 27, 30, False),
    ("nose", 31, 35, False),
    ("right_eye", 36, 41, True),
    ("left_eye", 42, 47, True),
    ("outer_lips", 48, 59, True),
    ("inner_lips", 60, 67, True),
)
PUPILS = ("right_pupil", "left_pupil")


def keypoint_names() -> list[str]:
    """Of the 70 points, in order: jaw_0, ..., left_pupil."""
    names = [
        f"{name}_{number - first}"
        for name, first, last, _ in LINES
        for number in range(first, last + 1)
    ]
    return [*names, *PUPILS]


def write_coco(path: Path, samples: Callable[[], Iterable[dict[str, Any]]], told: str) -> None:
    """Write the labels of all samples, one by one, so that a set of any length fits memory.

    samples: gives the labels of all samples anew each time. told: what the set is.
    """
    lines = [(first + 1, last + 1, is_closed) for _, first, last, is_closed in LINES]
    skeleton = [[point, point + 1] for first, last, _ in lines for point in range(first, last)]
    category = {
        "id": 1,
        "name": "person",
        "supercategory": "person",
        "keypoints": keypoint_names(),
        "skeleton": skeleton + [[last, first] for first, last, is_closed in lines if is_closed],
    }
    head = json.dumps({"info": {"description": told}, "categories": [category]})
    with path.open("w", encoding="utf-8") as file:
        file.write(head[:-1])
        for name, entry in (("images", _image), ("annotations", _annotation)):
            file.write(f', "{name}": [')
            for number, sample in enumerate(samples()):
                file.write(",\n" if number else "\n")
                json.dump(entry(sample), file)
            file.write("]")
        file.write("}\n")


def _image(sample: dict[str, Any]) -> dict[str, Any]:
    width, height = (sample["camera"][each] for each in ("width", "height"))
    name = f"{sample['id']}.png"
    return {"id": sample["index"], "file_name": name, "width": width, "height": height}


def _annotation(sample: dict[str, Any]) -> dict[str, Any]:
    width, height = (sample["camera"][each] for each in ("width", "height"))
    points = sample["landmarks"]
    keypoints: list[float] = []
    for (x, y), is_visible in zip(points["pixels"], points["visible"], strict=True):
        is_inside = 0.0 <= x < width and 0.0 <= y < height
        keypoints += [x, y, 1 + is_visible] if is_inside else [0.0, 0.0, 0]
    return {
        "id": sample["index"] + 1,  # 0 tells COCO's evaluation that nothing was matched
        "image_id": sample["index"],
        "category_id": 1,
        "iscrowd": 0,
        "bbox": sample["face_box"],
        "area": sample["face_box"][2] * sample["face_box"][3],
        "keypoints": keypoints,
        "num_keypoints": sum(1 for visibility in keypoints[2::3] if visibility),
    }
