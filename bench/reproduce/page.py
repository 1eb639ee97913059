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
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path

from risorius import __version__
from risorius.app.files import check_file, save_png, save_text

from ..report import processor
from .experiments import EXPERIMENTS, INFERRED, Finding, Result, Verdict

PAGE, RESULTS = "index.html", "results.json"
PAPER = "doi 10.1007/s00371-002-0185-8"
STYLE = Path(__file__).parent / "page.css"
TITLE = "Dynamically refined animated triangle meshes, repeated"
ABOUT = (
    "K. Kähler, J. Haber, H.-P. Seidel, <cite>Dynamically refining animated triangle meshes for "
    "rendering</cite>, The Visual Computer 2003, in the order of the paper: what it says, and what "
    "this program measures."
)
NOT_GIVEN = (
    "Weights stand in its Figures 3 and 4 alone, thresholds and test meshes nowhere. These were "
    "inferred or chosen:"
)
TIMES = (
    "Times are medians, with quartiles in brackets. <i>noise</i>: more triangles took less time "
    "than fewer, which cannot be; close other programs and try again."
)
COLUMNS = ("what the paper says", "paper", "here", "allowed", "")


def check_folder(folder: Path) -> None:
    """Raise UserError, before any work is done, where the files cannot be written."""
    for name in (PAGE, RESULTS, *(f"{each.name}.png" for each in EXPERIMENTS if each.picture)):
        check_file(folder / name)


def write(folder: Path, results: Sequence[Result]) -> None:
    """Write page, figures and pictures into `folder`, which was checked."""
    for result in results:
        if result.outcome.picture is not None:
            save_png(folder / f"{result.experiment.name}.png", result.outcome.picture)
    about = surroundings(results)
    save_text(folder / RESULTS, json.dumps(figures(results, about), indent=1) + "\n")
    save_text(folder / PAGE, page(results, about))


def surroundings(results: Sequence[Result]) -> dict[str, str]:
    """When, with what and on which machine it was made."""
    renderers = dict.fromkeys(r.outcome.renderer for r in results if r.outcome.renderer)
    return {
        "made by": f"Risorius {__version__}, Python {platform.python_version()}",
        "on": datetime.datetime.now().astimezone().strftime("%Y-%m-%d %H:%M %Z"),
        "processor": f"{processor()}, {os.cpu_count()} cores",
        "system": f"{platform.system()} {platform.machine()}",
        "OpenGL": ", ".join(renderers),
    }


def figures(results: Sequence[Result], about: Mapping[str, str]) -> dict[str, object]:
    """What programs may want to know."""
    return {
        "paper": PAPER,
        **about,
        "missed": sum(len(result.missed) for result in results),
        "experiments": [
            {
                "name": result.experiment.name,
                "title": result.experiment.title,
                "place": result.experiment.place,
                "claims": [
                    {
                        "value": each.claim.value,
                        "statement": each.claim.statement,
                        "paper": each.claim.paper,
                        "ours": each.measured.value,
                        "quartiles": each.measured.quartiles,
                        "allowed": each.allowed,
                        "verdict": each.verdict.value,
                    }
                    for each in result.findings
                ],
            }
            for result in results
        ],
        "inferred": INFERRED,
    }


def page(results: Sequence[Result], about: Mapping[str, str]) -> str:
    """The whole file. about: see `surroundings`."""
    findings = [finding for result in results for finding in result.findings]
    told = [finding for finding in findings if finding.verdict is not Verdict.MET]
    links = (f'<a href="#{r.experiment.name}">{_text(r.experiment.title)}</a>' for r in results)
    inferred = [tuple(map(_text, each.values())) for each in INFERRED]
    machine = (f"<dt>{name}</dt><dd>{_text(value)}</dd>" for name, value in about.items())
    return "\n".join(
        [
            "<!DOCTYPE html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{TITLE}</title>",
            f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head><body>",
            f"<header><h1>{TITLE}</h1>",
            f"<p>{ABOUT}</p>",
            f'<p class="sum"><b>{len(findings) - len(told)}</b> of {len(findings)} statements '
            "are met.</p><ul>",
            *(f"<li>{_badge(f)} {_text(_told(f))}</li>" for f in told),
            "</ul><nav>",
            *links,
            "</nav></header>",
            *map(_section, results),
            f'<section id="inferred"><h2>What the paper does not give</h2><p>{NOT_GIVEN}</p>',
            _table(("section", "what", "value", "why"), inferred),
            '</section><section id="machine"><h2>Where this was made</h2><dl>',
            *machine,
            f"</dl><p>{TIMES}</p></section></body></html>",
            "",
        ]
    )


def _told(finding: Finding) -> str:
    return f"{finding.claim.value}: {finding.ours}, allowed {finding.allowed}"


def _section(result: Result) -> str:
    """One experiment: its picture, its table, its claims."""
    experiment, outcome = result.experiment, result.outcome
    lines = [
        f'<section id="{experiment.name}">',
        f'<p class="place">{_text(experiment.place)}</p>',
        f"<h2>{_text(experiment.title)}</h2>",
    ]
    if outcome.picture is not None:
        file = f"{experiment.name}.png"
        lines.append(f'<a href="{file}"><img src="{file}" alt="{_text(experiment.about)}"></a>')
    if outcome.text:
        lines.append(f"<pre>{_text(outcome.text)}</pre>")
    cells = [
        (
            f"{_text(each.claim.statement)}<small>{_text(each.claim.value)}</small>",
            *map(_text, (each.claim.paper, each.ours, each.allowed)),
            _badge(each),
        )
        for each in result.findings
    ]
    command = f'<p class="command"><code>risorius reproduce {experiment.name}</code></p>'
    return "\n".join([*lines, _table(COLUMNS, cells), command, "</section>"])


def _badge(finding: Finding) -> str:
    return f'<span class="{finding.verdict.value.lower()}">{finding.verdict.value}</span>'


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table that a narrow screen shows as a list: each cell carries its title."""
    lines = ["".join(f"<th>{title}</th>" for title in titles), "</tr></thead><tbody>"]
    for row in rows:
        cells = zip(titles, row, strict=True)
        tagged = "".join(f'<td data-title="{title}">{cell}</td>' for title, cell in cells)
        lines.append(f"<tr>{tagged}</tr>")
    return "\n".join(["<table><thead><tr>", *lines, "</tbody></table>"])


def _text(text: str) -> str:
    return escape(text, quote=True)
