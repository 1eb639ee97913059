"""All that is repeated of the paper, in one folder: `risorius reproduce all`.

index.html      everything in the order of the paper, for any browser, without a network
results.json    the same for programs
NAME.png        the pictures
"""

from __future__ import annotations

import datetime
import json
import os
import platform
from collections.abc import Callable
from pathlib import Path

from risorius import __version__
from risorius.app.files import check_file, save_png, save_text

from ..report import processor
from .claims import Finding
from .experiments import EXPERIMENTS, Result
from .inferred import INFERRED
from .page import page

PAGE, RESULTS = "index.html", "results.json"
PAPER = "doi 10.1007/s00371-002-0185-8"


def check_folder(folder: Path) -> None:
    """Raise UserError, before any work is done, where the files cannot be written."""
    for name in (PAGE, RESULTS, *(f"{each.name}.png" for each in EXPERIMENTS if each.has_picture)):
        check_file(folder / name)


def reproduce(folder: Path, *, progress: Callable[[str], object] = lambda _: None) -> list[Result]:
    """Make every experiment, and write page, figures and pictures into `folder`, which was checked.

    `progress`: called with the title of each experiment before it begins.
    """
    results = []
    for experiment in EXPERIMENTS:
        progress(experiment.title)
        results.append(experiment.run())
    for result in results:
        for name, picture in result.outcome.pictures.items():
            save_png(folder / f"{name}.png", picture)
    about = surroundings(results)
    save_text(folder / RESULTS, json.dumps(figures(results, about), indent=1) + "\n")
    save_text(folder / PAGE, page(results, about, INFERRED))
    return results


def surroundings(results: list[Result]) -> dict[str, str]:
    """When, with what and on which machine it was made."""
    renderers = dict.fromkeys(r.outcome.renderer for r in results if r.outcome.renderer)
    return {
        "paper": PAPER,
        "version": f"Risorius {__version__}, Python {platform.python_version()}",
        "date": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        "processor": f"{processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "opengl": ", ".join(renderers),
    }


def figures(results: list[Result], about: dict[str, str]) -> dict[str, object]:
    """What programs may want to know."""
    return {
        **about,
        "missed": sum(len(result.missed) for result in results),
        "experiments": [
            {
                "name": result.experiment.name,
                "title": result.experiment.title,
                "place": result.experiment.place,
                "pictures": [f"{name}.png" for name in result.outcome.pictures],
                "claims": [_claim(finding) for finding in result.findings],
            }
            for result in results
        ],
        "inferred": [vars(each) for each in INFERRED],
    }


def _claim(finding: Finding) -> dict[str, object]:
    claim, measured = finding.claim, finding.measured
    return {
        "value": claim.value,
        "statement": claim.statement,
        "paper": claim.expected,
        "ours": measured.value,
        "quartiles": measured.quartiles,
        "allowed": finding.allowed,
        "verdict": finding.verdict.value,
    }
