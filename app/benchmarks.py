"""What `risorius bench` prints: measurements of bench/ as tables."""

from __future__ import annotations

import json
import platform
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from risorius.bench import gaps, meshes, motion, simulate, soak, tearing


def simulate_table(rounds: int, sizes: Sequence[int] = simulate.SIZES) -> str:
    """Time a 60 Hz frame of the simulation on meshes of several sizes; the text to print."""
    lines = [
        f"One frame of 1/60 s, serial, one core of {processor()}: medians of {rounds}",
        "interleaved rounds; set up is not counted.",
        "",
        f"{'motion':28} {'vertices':>8} {'triangles':>9} {'ms':>8} {'best':>8} {'ns/vertex':>9}",
    ]
    for row in simulate.run(rounds=rounds, sizes=sizes):
        lines.append(
            f"{row.motion:28} {row.vertices:8d} {row.triangles:9d} {row.milliseconds:8.3f} "
            f"{row.best_milliseconds:8.3f} {row.nanoseconds_per_vertex:9.0f}"
        )
    return "\n".join(lines)


def motion_table(reference: Path) -> str:
    """Score simulated against scanned skin motion; the text to print."""
    rows, left_out = motion.run(reference)
    lines = [
        "Simulated against scanned displacement, area weighted: cosine 1 and magnitude 1 are equal",
        "fields, residual is the squared difference over the squared scan, half is the share of",
        "the motion that half the controls give. Yardsticks (cosine): a rigid blob at the scanned",
        "peak and the geometric muscle of Waters 1987, each the best of several.",
        "",
        f"{'shape':20} {'cosine':>7} {'magnitude':>9} {'residual':>8} {'half':>5} "
        f"{'blob':>6} {'Waters':>6}",
    ]
    for row in [*rows, motion.mean_row(rows)]:
        lines.append(
            f"{row.shape:20} {row.cosine:7.3f} {row.magnitude:9.2f} {row.residual:8.3f} "
            f"{row.half:5.2f} {row.blob:6.3f} {row.waters:6.3f}"
        )
    if left_out:
        names = ", ".join(left_out)
        lines += ["", f"left out, no skin moves or bench/shapes.toml does not know it: {names}"]
    return "\n".join(lines)


def soak_table(minutes: float) -> str:
    """Drive the face with random input for a long time; the text to print."""
    seen = soak.run(minutes=minutes)
    return "\n".join(
        [
            f"{seen.seconds / 60.0:.1f} simulated minutes, {seen.frames} frames of 1/240 to",
            "1/20 s, every control at random in every frame:",
            f"finite            {'yes' if seen.finite else 'NO'}",
            f"furthest          {seen.furthest:.2f} mm from rest",
            f"2 s after release {seen.left_over:.6f} mm from rest",
            f"energy growth     {seen.growth:.1e} of a blow, most in a frame without input",
            f"same bytes        {'yes' if seen.same_bytes else 'NO'}",
            f"mirrored input    {seen.mirror_error:.1e} mm from the mirrored motion",
        ]
    )


def tearing_table(mixtures: int) -> str:
    """Look for torn skin in all expressions and in random mixtures; the text to print."""
    poses = tearing.run(mixtures=mixtures)
    lines = [
        f"{len(poses)} poses: every row of the layers and {mixtures} random mixtures of muscles.",
        f"triangles turned by more than a right angle: {sum(pose.inverted for pose in poses)} "
        f"in {sum(pose.inverted > 0 for pose in poses)} poses",
        "",
        "worst         value  in",
    ]
    for title, unit, part in (
        ("inverted", "", "inverted"), ("lips", " mm", "lips"), ("lids", " mm", "lids"),
        ("teeth", " mm", "teeth"),
    ):  # fmt: skip
        worst = max(poses, key=lambda pose: float(getattr(pose, part)))
        value = float(getattr(worst, part))
        lines.append(f"{title:10} {f'{value:.4g}{unit}':>9}  {worst.name if value > 0.0 else '-'}")
    return "\n".join(lines)


def gaps_table(poses: Sequence[gaps.Pose]) -> str:
    """What stays open in poses that ought to be shut; the text to print."""

    def millimetres(value: float | None) -> str:
        return f"{'-' if value is None else f'{value:.2f}':>6}"

    lines = [
        f"{len(poses)} poses of the built-in head, as simulated and as refined, the worse:",
        "lips  widest slit between lips that nothing opens, from five sides [mm]",
        "lids  widest opening of an eye that is shut, from the front [mm]",
        "sunk  how deep skin lies in an eyeball, deeper than at rest [mm]",
        "",
        f"{'pose':14} {'lips':>6} {'lids':>6} {'sunk':>6}",
    ]
    for pose in poses:
        values = (millimetres(value) for value in (pose.lips, pose.lids, pose.sunk))
        lines.append(f"{pose.name:14} {' '.join(values)}")
    lines += ["", "worst      mm  asked"]
    for title, most in (("lips", gaps.LIPS_MOST), ("lids", gaps.LIDS_MOST)):
        value, pose = gaps.worst(poses, title)
        verdict = "met" if value < most else "MISSED"
        lines.append(f"{title:6} {value:6.2f}  {most} {verdict:6}  {pose.name}")
    value, pose = gaps.worst(poses, "sunk")
    lines.append(f"{'sunk':6} {value:6.2f}              {pose.name}")
    return "\n".join(lines)


def gaps_json(poses: Sequence[gaps.Pose]) -> str:
    """The same figures for programs."""
    return json.dumps([asdict(pose) for pose in poses], indent=1) + "\n"


def meshes_table(seen: Sequence[meshes.Seen]) -> str:
    """What became of the meshes of a folder; the text to print."""
    refined = [each for each in seen if not each.left_out]
    lines = [f"{'triangles':>9} {'frames':>6} {'broken':>6}  mesh"]
    for each in seen:
        note = f": left out, {each.left_out}" if each.left_out else ""
        note += ": cut short" if each.is_cut_short else ""
        lines.append(
            f"{each.triangles:9d} {each.frames:6d} {len(each.broken):6d}  {each.name}{note}"
        )
        lines += [f"{'':25}{line}" for line in each.broken]
    lines += [
        "",
        f"{len(seen)} files: {len(refined)} refined, {len(seen) - len(refined)} left out, "
        f"{sum(each.is_cut_short for each in seen)} cut short;",
        f"{sum(each.triangles for each in refined)} triangles, "
        f"{sum(each.frames for each in seen)} frames, "
        f"{sum(len(each.broken) for each in seen)} of them broken",
    ]
    return "\n".join(lines)


def processor() -> str:
    """The name of this machine's processor."""
    information = Path("/proc/cpuinfo")
    if information.exists():
        for line in information.read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    return platform.processor() or platform.machine()
