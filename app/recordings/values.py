"""Units of values, and flags of rows without a face, for tables and JSON of all programs.

Shapes are 0 to 1, or 0 to 100 in programs for animation. Action units are 0 to 1, 0 to 5 (FACS' A
to E), or 0 to 100. While trackers see no face, they write zeros or the last values; many have a
flag for this.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np

from risorius.geometry.arrays import Flags, Floats64

from ..text import counted
from .names import ARKIT_SHAPES, LARGEST_VALUE, letters_of, measured

COUNT_COLUMN = "blendshapecount"  # number of values in a row
NEVER_AT_REST = ("browDownLeft", "browDownRight", "noseSneerLeft", "noseSneerRight",
                 "mouthShrugUpper")  # fmt: skip
ZERO_TOLERANCE = 1e-6


def is_flag(name: str) -> bool:
    """Whether a column or key is a flag of a visible face."""
    letters = letters_of(name)
    sure_flags = (
        "facedetected",
        "detected",
        "hasface",
        "facefound",
        "facepresent",
        "facevisible",
        "istracked",
        "tracked",
        "istracking",
        "facetracked",
        "isfacetracked",
        "valid",
        "isvalid",
        "success",
        "confidence",
        "faceconfidence",
        "detectionconfidence",
        "trackingconfidence",
    )
    return letters in sure_flags or letters == COUNT_COLUMN


def rows_without_face(
    names: Iterable[str], texts: Callable[[str], Sequence[str]], count: int
) -> Flags:
    """Return the rows in which a flag reports that no face is visible, shape (count,).

    names: names of columns or keys. texts: function that returns the cells of a name, "" for empty
    cells. A confidence is used if there is no other flag.
    """
    lost = np.zeros(count, dtype=bool)
    flags = [name for name in names if is_flag(name)]
    plain = [name for name in flags if "confidence" not in letters_of(name)]
    least_confidence = 0.5  # a flag is 0 or 1; a lower confidence means no face
    for name in plain or flags:
        values = np.array([_flag_in(cell) for cell in texts(name)])
        if letters_of(name) == COUNT_COLUMN:
            is_lost = values == 0.0
            if is_lost.all():  # the program does not count
                continue
        else:
            highest = float(np.nanmax(values, initial=0.0))
            is_lost = values < least_confidence * (100.0 if highest > 1.5 else 1.0)
        lost |= is_lost
    return lost


def shares(shapes: Mapping[str, Floats64], notes: list[str]) -> dict[str, Floats64]:
    """Scale ARKit's shapes to 0 to 1, or a little beyond; invalid values become NaN.

    If the face of a take is never at 0, rows of zeros are rows without a face, and become NaN.
    """
    found = from_percent(shapes, LARGEST_VALUE, "Shapes", notes)
    far = 0
    beyond = 0
    for name, values in found.items():
        kept = measured(name, values)
        far += int(np.isnan(kept).sum() - np.isnan(values).sum())
        found[name] = kept
        beyond += int(np.sum((kept < -0.001) | (kept > 1.001)))
    if far:
        are = "is" if far == 1 else "are"
        were = "was" if far == 1 else "were"
        notes.append(
            f"{counted(far, 'value')} of shapes {are} far from 0 to 1 and {were} left out."
        )
    if beyond:
        were = "was" if beyond == 1 else "were"
        notes.append(f"{counted(beyond, 'value')} of shapes {were} cut off at 0 and 1.")
    lost = _rows_of_zeros(found)
    if lost.any():
        frames = counted(int(lost.sum()), "frame")
        notes.append(f"All shapes are 0 in {frames}, as in frames without a face.")
        found = without_rows(found, lost)
    return found


def intensities(units: Mapping[str, Floats64], notes: list[str]) -> dict[str, Floats64]:
    """Return action units from 0 to 1; values of FACS, 0 to 5 (A to E), and percent are scaled."""
    highest_unit = 6.0  # a value of 0 to 5 cannot be larger
    found = from_percent(units, highest_unit, "Action units", notes)
    found = {name: np.where(np.abs(v) > highest_unit, np.nan, v) for name, v in found.items()}
    highest = max((float(np.nanmax(values, initial=0.0)) for values in found.values()), default=0.0)
    most_overshoot = 1.05  # largest smoothed value on a scale of 0 to 1
    if highest > most_overshoot:
        notes.append("Action units go from 0 to 5 and were divided by 5.")
        found = {name: values / 5.0 for name, values in found.items()}
    return found


def without_rows(channels: Mapping[str, Floats64], lost: Flags) -> dict[str, Floats64]:
    """Return the channels with NaN in rows without a face."""
    return {name: np.where(lost, np.nan, values) for name, values in channels.items()}


def is_calibrated(shapes: Mapping[str, Floats64], notes: list[str]) -> bool:
    """Whether the neutral face was subtracted, so that shapes of NEVER_AT_REST are often 0.

    Rows without a face, which are NaN, are ignored.
    """
    resting = [shapes[name] for name in NEVER_AT_REST if name in shapes]
    at_zero = [values[np.isfinite(values)] <= ZERO_TOLERANCE for values in resting]
    calibrated = sum(bool(rows.size and np.mean(rows) > 0.2) for rows in at_zero) >= 3
    if calibrated and len(shapes) == len(ARKIT_SHAPES):
        notes.append("The take is calibrated: its neutral face is at 0.")
    return calibrated


def from_percent(
    channels: Mapping[str, Floats64], most: float, kind: str, notes: list[str]
) -> dict[str, Floats64]:
    """Return the channels, divided by 100 if their values can only be percent.

    most: the highest value that is possible in the other unit.
    """
    if not channels:
        return {}
    values = np.array(list(channels.values()))
    most_percent = 300.0  # largest value; programs for animation allow more than 100
    is_large = (values > most) & (values <= most_percent)
    moving = np.any(np.nan_to_num(values) != 0.0, axis=0)
    fraction_of_percent = 0.05  # if more rows have large values, these are percent, not errors
    if not is_large.any() or is_large.any(axis=0).sum() <= fraction_of_percent * moving.sum():
        return dict(channels)
    notes.append(f"{kind} go from 0 to 100 and were divided by 100.")
    return {name: each / 100.0 for name, each in channels.items()}


def _rows_of_zeros(shapes: Mapping[str, Floats64]) -> Flags:
    """Return the rows of zeros, if they mean that no face was found; else none.

    Such rows mean this if three shapes of NEVER_AT_REST are never near 0 in the other rows.
    """
    if not shapes:
        return np.zeros(0, dtype=bool)
    table = np.stack([*shapes.values()])
    is_empty = np.all(np.isnan(table), axis=0)
    is_zero = np.all(np.abs(np.nan_to_num(table)) <= ZERO_TOLERANCE, axis=0)
    is_zero &= ~is_empty
    others = ~(is_zero | is_empty)
    nowhere = np.zeros(len(is_zero), dtype=bool)
    if not (is_zero.any() and others.any()):
        return nowhere
    raised = 0
    for name in NEVER_AT_REST:
        if name in shapes and np.nanmin(shapes[name][others], initial=1.0) > 0.02:
            raised += 1
    return is_zero if raised >= 3 else nowhere


def _flag_in(cell: str) -> float:
    """Return a flag as a number; NaN for any other text."""
    word = cell.strip().casefold()
    words = {"true": 1.0, "yes": 1.0, "false": 0.0, "no": 0.0}
    if word in words:
        return words[word]
    try:
        return float(word)
    except ValueError:
        return np.nan
