"""Help with options in groups under headings, and the replacements of removed options."""

from __future__ import annotations

from collections.abc import Mapping

import click

# Names of parameters, in the order of the help.
OPTIONS_BY_HEADING: Mapping[str, tuple[str, ...]] = {
    "Output": (
        *("output", "name", "sheet", "size", "fps", "times", "compare", "passes"),
        *("refined", "overwrite", "once", "quiet"),
    ),
    "Motion": ("settings", "scene", "script", "sound", "alive"),
    "Live face": ("live", "port", "address", "gains", "mirror"),
    "Face": ("head", "landmarks"),
    "Refinement": ("look", "refiner", "refiner_settings"),
    "Picture": ("camera", "background", "style_settings", "anatomy"),
}

_CONVERT_HINT = (
    "convert the recording first: risorius convert RECORDING {option} ... -o script.toml"
)
_STYLE_HINT = "write --style {name}=VALUE"
_STYLE_WORD_HINT = "write --style {name}"
MOVED_OPTIONS: Mapping[str, str] = {
    "--neutral": _CONVERT_HINT,
    "--gain": _CONVERT_HINT,
    "--mirror": _CONVERT_HINT,
    "--lead": _CONVERT_HINT,
    "--face": _CONVERT_HINT,
    "--rate": _CONVERT_HINT,
    "--skin": _STYLE_HINT,
    "--wrinkles": _STYLE_HINT,
    "--light": _STYLE_HINT,
    "--wireframe": _STYLE_WORD_HINT,
    "--splits": _STYLE_WORD_HINT,
    "--skin-opacity": "write --anatomy muscles,skull,opacity=VALUE",
    "--dissect": "write --anatomy muscles,skull,dissect=VALUE",
    "--person": "write --head NUMBER, or the person's name; `risorius rig` takes it as HEAD",
    "--range": "write --time FROM:TO",
    "--turntable": "write --camera turntable, or --camera VIEW,turntable",
    "--shading": "risorius reproduce figure9 draws flat and Gouraud shading",
    "--samples": "edges are always smooth",
    "--captions": "a comparison always has captions",
    "--no-captions": "a comparison always has captions",
    "--skin-maps": "pictures always have skin maps; the window can leave them out",
    "--no-skin-maps": "pictures always have skin maps; the window can leave them out",
}
"""The replacement of each removed option; {option}: as typed, {name}: without dashes."""


class RenewedCommand(click.Command):
    """A command whose errors name the replacements of options that were removed."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Parse arguments; the error for a removed option names its replacement."""
        try:
            return super().parse_args(ctx, args)
        except click.NoSuchOption as error:
            instead = MOVED_OPTIONS.get(error.option_name)
            has_style = any(each.name == "style_settings" for each in self.params)
            if instead is None or (instead == _STYLE_HINT and not has_style):
                raise
            name = error.option_name.removeprefix("--")
            cure = instead.format(option=error.option_name, name=name)
            raise click.UsageError(f"{error.option_name} was removed: {cure}", ctx) from None


class GroupedCommand(RenewedCommand):
    """A `RenewedCommand` whose help lists options under headings."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the options, group by group."""
        options = [each for each in self.get_params(ctx) if isinstance(each, click.Option)]
        records = {each.name: each.get_help_record(ctx) for each in options}
        rows = {name: record for name, record in records.items() if record is not None}
        for heading, names in OPTIONS_BY_HEADING.items():
            group = [rows.pop(name) for name in names if name in rows]
            if heading == "Output" and "output" not in records:
                heading = "Window"
            if group:
                with formatter.section(heading):
                    formatter.write_dl(group)
        with formatter.section("Others"):
            formatter.write_dl(list(rows.values()))  # at least --help
