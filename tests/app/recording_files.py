"""Recording files, written after the descriptions of their formats."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from risorius.app.recordings.names import ARKIT_SHAPES
from risorius.app.recordings.reading import read_take
from risorius.app.recordings.take import Take
from risorius.geometry.arrays import Floats64

Columns = Mapping[str, Sequence[object] | Floats64]

ANGLE_COLUMNS = (
    "HeadYaw", "HeadPitch", "HeadRoll", "LeftEyeYaw", "LeftEyePitch", "LeftEyeRoll",
    "RightEyeYaw", "RightEyePitch", "RightEyeRoll",
)  # fmt: skip


def has_note(notes: tuple[str, ...], words: str) -> bool:
    """Whether a note contains these words."""
    return any(words in note for note in notes)


def take_of(
    kind: str = "Live Link Face", *, seconds: float = 4.0, rate: float = 10.0, **channels: object
) -> Take:
    """A take whose channels are given as constant numbers or as values."""
    times = np.arange(round(seconds * rate) + 1) / rate
    arrays = {
        name: np.broadcast_to(np.asarray(values, float), times.shape).copy()
        for name, values in channels.items()
    }
    return Take(kind, "take.csv", times, arrays)


def table(columns: Columns) -> str:
    """A table as text."""
    rows = zip(*columns.values(), strict=True)
    lines = [",".join(columns)]
    for row in rows:
        cells = [f"{cell:.6f}" if isinstance(cell, float) else str(cell) for cell in row]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


def written(path: Path, columns: Columns) -> Path:
    """Write the table to a file; return its path."""
    path.write_text(table(columns), encoding="utf-8")
    return path


def take_in(folder: Path, columns: Columns, *, rate: float | None = None) -> Take:
    """The take read from a table with these columns."""
    return read_take(written(folder / "take.csv", columns), rate=rate)


def timecodes(frames: Sequence[float] | Floats64, rate: int = 60, start: int = 36_000) -> list[str]:
    """`HH:MM:SS:FF.fff` for frames counted from `start` [s]; .fff are thousandths of a frame."""
    found = []
    for frame in frames:
        whole, part = divmod(round(float(frame) * 1000), 1000)
        second, number = divmod(whole, rate)
        second += start
        hours = second // 3600
        minutes = second // 60 % 60
        found.append(f"{hours:02}:{minutes:02}:{second % 60:02}:{number:02}.{part:03}")
    return found


def live_link(count: int = 120, unit: float = 1.0) -> dict[str, Sequence[object] | Floats64]:
    """A raw take of Live Link Face: a face looks around; angles are in units of `unit` radians.

    Eyes and shapes move as in the app: pitch = 0.61 down - 0.44 up, yaw = 0.62 in - 0.59 out for
    the left eye, the opposite for the right eye [rad]; + is down and to the subject's right. The
    axes of the eyeballs point 4 degrees outward from the gaze.
    """
    time = np.arange(count) / 60.0
    down = 0.3 * np.sin(3.0 * time)
    right = 0.2 * np.sin(5.0 * time + 1.0)
    shapes = {name: 0.2 + 0.1 * np.sin(time + place) for place, name in enumerate(ARKIT_SHAPES)}
    for side, inward in (("Left", right), ("Right", -right)):
        shapes[f"eyeLookDown{side}"] = np.maximum(down, 0.0) / 0.61
        shapes[f"eyeLookUp{side}"] = np.maximum(-down, 0.0) / 0.44
        shapes[f"eyeLookIn{side}"] = np.maximum(inward, 0.0) / 0.62
        shapes[f"eyeLookOut{side}"] = np.maximum(-inward, 0.0) / 0.59
    angles = {name: np.zeros(count) for name in ANGLE_COLUMNS}
    angles |= {"HeadYaw": 0.5 * np.sin(time), "HeadPitch": 0.2 * np.cos(time)}
    angles |= {"HeadRoll": 0.1 * np.sin(2.0 * time)}
    outward = np.radians(4.0)
    angles |= {"LeftEyeYaw": right - outward, "RightEyeYaw": right + outward}
    angles |= {"LeftEyePitch": down, "RightEyePitch": down}
    named = {name[0].upper() + name[1:]: values for name, values in shapes.items()}
    return {
        "Timecode": timecodes(np.arange(count)),
        "BlendShapeCount": [61] * count,
        **named,
        **{name: values / unit for name, values in angles.items()},
    }


def openface(count: int = 60) -> dict[str, Sequence[object] | Floats64]:
    """An OpenFace 2 table with some of its columns: a face smiles, turns, looks up and down."""
    time = np.arange(count) / 30.0
    turn = 0.3 * np.sin(time)  # to the subject's right
    return {
        "frame": np.arange(1, count + 1).tolist(),
        "face_id": [0] * count,
        "timestamp": time,
        "confidence": [0.98] * count,
        "success": [1] * count,
        "gaze_angle_x": np.full(count, 0.02),
        "gaze_angle_y": 0.25 + 0.1 * np.sin(2.0 * time),
        "eye_lmk_x_0": np.full(count, 300.0),
        "pose_Tx": np.full(count, 12.0),
        "pose_Rx": 0.1 * np.cos(time),
        "pose_Ry": turn,
        "pose_Rz": 0.05 * np.sin(2.0 * time),
        "X_0": np.full(count, -40.0),
        "p_scale": np.full(count, 2.5),
        "AU01_r": np.full(count, -0.2),
        "AU12_r": 2.5 + 2.5 * np.sin(time),
        "AU45_r": np.full(count, 0.5),
        "AU12_c": [1] * count,
        "AU28_c": [0, 1] * (count // 2),
    }


def pyfeat(count: int = 20) -> dict[str, Sequence[object] | Floats64]:
    """A py-feat 1 table: every frame of a film, without times, head angles in degrees."""
    return {
        "frame": list(range(count)),
        "FaceRectX": np.full(count, 190.0),
        "FaceScore": np.full(count, 0.99),
        "x_0": np.full(count, 192.0),
        "AU01": np.full(count, 0.5),
        "AU12": np.linspace(0.0, 0.9, count),
        "Pitch": np.linspace(-5.0, 10.0, count),
        "Roll": np.full(count, 3.0),
        "Yaw": np.linspace(0.0, 20.0, count),
        "happiness": np.full(count, 0.9),
        "input": ["film.mp4"] * count,
    }


def pyfeat_2(count: int = 20) -> dict[str, Sequence[object] | Floats64]:
    """A py-feat 2 table: units and shapes of MediaPipe, every other frame, angles in radians."""
    columns = pyfeat(count)
    columns |= {"frame": list(range(0, 2 * count, 2)), "AU06": np.full(count, 0.4)}
    columns |= {name: np.radians(columns[name]) for name in ("Pitch", "Roll", "Yaw")}
    shapes = {name: np.linspace(0.0, 0.5, count) for name in ARKIT_SHAPES if name != "tongueOut"}
    mesh = {f"mesh_{axis}_{number}": np.full(count, 0.1) for axis in "xy" for number in range(900)}
    return columns | {
        "gaze_pitch": np.full(count, 0.1),
        "gaze_yaw": np.full(count, 0.2),
        "_neutral": np.zeros(count),
        **shapes,
        **mesh,
        "FrameHeight": np.full(count, 1080.0),
        "approx_time": ["00:00"] * count,
        "Identity": ["Person_0"] * count,
    }
