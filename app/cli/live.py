"""Options of a face that is sent, which a window follows."""

from __future__ import annotations

from dataclasses import dataclass

import click
from click.core import ParameterSource

from ..errors import UserError
from ..live import LOOPBACK, PROTOCOLS, Listening
from ..recordings.playback import Playback
from .options import packed


@dataclass(frozen=True)
class Live:
    """What a window is told of a face that is sent to it."""

    live: str | None
    port: int | None
    address: str

    def listening(self, playback: Playback) -> Listening | None:
        """Where to listen, None for nowhere; UserError for what does not go together.

        playback: its mapping, gains and mirror are those of the live face.
        """
        if self.live is None:
            source = click.get_current_context().get_parameter_source
            for name in ("port", "address"):
                if source(name) is not ParameterSource.DEFAULT:
                    raise UserError(f"--{name} goes with --live, which says what is listened to")
            return None
        PROTOCOLS[self.live].check()
        return Listening(
            self.live,
            self.address,
            self.port,
            playback.mapping,
            playback.gains,
            playback.mirror,
        )


port_option = click.option(
    "--port", type=click.IntRange(1, 65535), help="Unless told, the protocol's own."
)
with_live = packed(
    "live",
    Live,
    click.option("--live", type=click.Choice(list(PROTOCOLS)), help="Follow a face that is sent."),
    port_option,
    click.option(
        "--address",
        default=LOOPBACK,
        show_default=True,
        help="Of this computer, on which to listen; 0.0.0.0 for its whole network.",
    ),
)
