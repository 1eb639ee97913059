"""The script's sound in the window: it plays with the script, and sets the pace.

The picture follows the sound, because the sound device has its own clock and sound must not jump.
So time passes slightly faster or slower for the picture until both agree. After a stall, the
picture skips the time that was heard meanwhile. If the user or a loop jumps, the sound follows.
"""

from __future__ import annotations

from pathlib import Path

from ...errors import UserError
from ...sound.decoding import Sound, load_sound
from ...sound.player import NoDeviceError, Player
from .physics import MOST_STEPS_PER_FRAME, STEP_TIME
from .session import Session

# [s] of the script in one frame; more is a jump.
LONGEST_CATCH_UP = (MOST_STEPS_PER_FRAME + 1) * STEP_TIME


class Soundtrack:
    """Plays the sound of a session's script; silent where there is no device."""

    sound: Sound | None

    def __init__(self, session: Session) -> None:
        self._session = session
        self._file: Path | None = None
        self._player: Player | None = None
        self._time = session.time  # script's time in the last frame [s]
        self._was_playing = False  # whether the script played in the last frame
        self.sound = None  # the script's sound; None without one

    def refresh(self) -> None:
        """Read the script's sound if it has changed; raises UserError, once, if this fails."""
        file = self._session.script.sound
        if file == self._file:
            return
        self.close()
        self._file = file
        self._time = self._session.time
        if file is None:
            return
        try:
            self.sound = load_sound(file)
            self._player = Player(self.sound)
        except NoDeviceError:
            pass
        except UserError as error:
            source = self._session.script.source
            raise UserError(f"{source}, 'sound': {error}; the script plays without") from None

    @property
    def is_heard(self) -> bool:
        """Whether the sound can be heard now."""
        return self._player is not None and self._player.is_heard

    def elapsed(self, seconds: float) -> float:
        """Return the time by which the picture advances [s], after `seconds` of real time."""
        session = self._session
        player = self._player
        if player is None or self.sound is None:
            return seconds
        was_playing, self._was_playing = self._was_playing, session.is_playing
        before, self._time = self._time, session.time
        if session.time >= self.sound.duration:
            player.stop()
        elif session.is_playing:
            return self._in_step(player, seconds, session.time - before)
        elif was_playing:
            player.stop()
        elif session.time != before:
            player.play(session.time, seconds=0.07)
        return seconds

    def _in_step(self, player: Player, seconds: float, went: float) -> float:
        """Return the time by which the picture advances [s], so that it agrees with the sound.

        went: advance of the script in the last frame [s].
        """
        session = self._session
        has_jumped = not 0.0 <= went <= LONGEST_CATCH_UP * session.speed
        if has_jumped or player.speed != session.speed:
            player.play(session.time, session.speed)
        if player.is_stuck:
            return seconds
        late = (player.position - session.time) / session.speed - seconds
        most_lag = 0.05  # [s] of lag before the picture skips
        if late > most_lag and session.time < session.script.duration:  # unless a recording goes on
            session.time = min(session.time + late * session.speed, session.script.duration)
            self._time = session.time
            return seconds
        catch_up_seconds = 0.3  # [s] in which most of a drift is corrected
        return max(seconds + late * min(seconds / catch_up_seconds, 1.0), 0.0)

    def rest(self) -> None:
        """Pause the sound while the window waits."""
        if self._player is not None:
            self._player.rest()

    def close(self) -> None:
        """Release sound and device."""
        if self._player is not None:
            self._player.close()
        self.sound = self._player = self._file = None
