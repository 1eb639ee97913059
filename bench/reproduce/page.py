"""The page of `risorius reproduce all`: one HTML file and pictures beside it, without a network."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape
from pathlib import Path

from .claims import Finding, Verdict
from .experiments import Result
from .inferred import Inferred

STYLE = Path(__file__).parent / "page.css"
TITLE = "Dynamically refined animated triangle meshes, repeated"
COLUMNS = ("what the paper says", "paper", "here", "allowed", "")
SURROUNDINGS = {
    "version": "made by",
    "date": "on",
    "processor": "processor",
    "system": "system",
    "opengl": "OpenGL",
}
"""What is told of the machine, and how it is called."""


def page(results: Sequence[Result], about: Mapping[str, str], inferred: Sequence[Inferred]) -> str:
    """The whole file.

    about: when, with what and where it was made, by the names in SURROUNDINGS.
    """
    body = [
        _head(results, about),
        *map(_section, results),
        _inferred(inferred),
        _surroundings(about),
    ]
    return "\n".join(
        [
            "<!DOCTYPE html>",
            '<html lang="en"><head><meta charset="utf-8">',
            '<meta name="viewport" content="width=device-width, initial-scale=1">',
            f"<title>{TITLE}</title>",
            f"<style>\n{STYLE.read_text(encoding='utf-8')}</style></head><body>",
            *body,
            "</body></html>",
            "",
        ]
    )


def _head(results: Sequence[Result], about: Mapping[str, str]) -> str:
    findings = [finding for result in results for finding in result.findings]
    told = [finding for finding in findings if finding.verdict is not Verdict.MET]
    met, count = len(findings) - len(told), len(findings)
    lines = [
        "<header>",
        f"<h1>{TITLE}</h1>",
        "<p>K. Kähler, J. Haber, H.-P. Seidel, <cite>Dynamically refining animated triangle meshes "
        "for rendering</cite>, The Visual Computer 2003, in the order of the paper: what it says, "
        f"and what this program measures. Made on {_text(about['date'])}.</p>",
        f'<p class="sum"><b>{met}</b> of {count} statements are met.</p>',
    ]
    if told:
        lines += ["<ul>", *(f"<li>{_told(finding)}</li>" for finding in told), "</ul>"]
    links = (f'<a href="#{r.experiment.name}">{_text(r.experiment.title)}</a>' for r in results)
    return "\n".join([*lines, "<nav>", *links, "</nav>", "</header>"])


def _told(finding: Finding) -> str:
    return (
        f"{_badge(finding.verdict)} {_text(finding.claim.value)}: {_text(finding.ours)}, allowed "
        f"{_text(finding.allowed)}"
    )


def _section(result: Result) -> str:
    """One experiment: its pictures, its table, its claims."""
    experiment = result.experiment
    lines = [
        f'<section id="{experiment.name}">',
        f'<p class="place">{_text(experiment.place)}</p>',
        f"<h2>{_text(experiment.title)}</h2>",
    ]
    for name in result.outcome.pictures:
        file = f"{name}.png"
        alt = _text(experiment.about)
        lines.append(f'<a href="{file}"><img src="{file}" alt="{alt}"></a>')
    if result.outcome.text:
        lines.append(f"<pre>{_text(result.outcome.text)}</pre>")
    if result.findings:
        lines.append(_table(COLUMNS, map(_cells, result.findings)))
    lines.append(f'<p class="command"><code>risorius reproduce {experiment.name}</code></p>')
    return "\n".join([*lines, "</section>"])


def _cells(finding: Finding) -> tuple[str, ...]:
    claim = finding.claim
    return (
        f"{_text(claim.statement)}<small>{_text(claim.value)}</small>",
        _text(claim.expected),
        _text(finding.ours),
        _text(finding.allowed),
        _badge(finding.verdict),
    )


def _badge(verdict: Verdict) -> str:
    return f'<span class="{verdict.value.lower()}">{verdict.value}</span>'


def _inferred(inferred: Sequence[Inferred]) -> str:
    rows = ((_text(i.place), _text(i.what), _text(i.value), _text(i.source)) for i in inferred)
    return "\n".join(
        [
            '<section id="inferred">',
            "<h2>What the paper does not give</h2>",
            "<p>Weights stand in its Figures 3 and 4 alone, thresholds and test meshes nowhere. "
            "These were inferred or chosen:</p>",
            _table(("section", "what", "value", "why"), rows),
            "</section>",
        ]
    )


def _surroundings(about: Mapping[str, str]) -> str:
    rows = [
        f"<dt>{title}</dt><dd>{_text(about[name])}</dd>" for name, title in SURROUNDINGS.items()
    ]
    return "\n".join(
        [
            '<section id="machine">',
            "<h2>Where this was made</h2>",
            "<dl>",
            *rows,
            "</dl>",
            "<p>Times are medians, with quartiles in brackets. <i>noise</i>: more triangles took "
            "less time than fewer, which cannot be; close other programs and try again.</p>",
            "</section>",
        ]
    )


def _table(titles: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A table that a narrow screen shows as a list: each cell carries its title."""
    head = "".join(f"<th>{title}</th>" for title in titles)
    lines = [f"<table><thead><tr>{head}</tr></thead><tbody>"]
    for row in rows:
        cells = zip(titles, row, strict=True)
        lines.append(
            "<tr>" + "".join(f'<td data-title="{t}">{cell}</td>' for t, cell in cells) + "</tr>"
        )
    return "\n".join([*lines, "</tbody></table>"])


def _text(text: str) -> str:
    return escape(text, quote=True)
