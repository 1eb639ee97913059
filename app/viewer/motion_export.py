"""File > Export motion: the script, or a pose held, in a file for other programs."""

from __future__ import annotations

from pathlib import Path

from ..errors import counted
from ..export.clip import record
from ..export.formats import FORMATS, Request, check_request, format_for, write
from ..scenes import FaceScene, Scene, build_scene
from ..script import Script, pose_script
from .files import Files
from .messages import Message, Task
from .session import Session


class MotionExport:
    """Asks for a file and writes it, which takes a while, in a frame after that was announced."""

    def __init__(self, session: Session, files: Files) -> None:
        self._session, self._files = session, files
        self._announced: Task | None = None

    @property
    def has_announced(self) -> bool:
        """Whether a file waits to be written."""
        return self._announced is not None

    def ask(self) -> None:
        """Ask for a file, whose suffix says the format."""
        suffixes = tuple(dict.fromkeys(suffix for each in FORMATS for suffix in each.suffixes))
        usual = dict.fromkeys(each.suffixes[0] for each in FORMATS if each.suffixes)
        stem = Path(self._session.name).stem
        self._files.ask(
            f"Export motion as {' '.join(usual)}",
            self._announce,
            saving=True,
            proposed=f"{stem}{suffixes[0]}",
            kind="Motion for other programs",
            suffixes=suffixes,
        )

    def _announce(self, path: Path) -> Message:
        """Say what will be written; UserError where it cannot be."""
        chosen, request = format_for(path, None), Request(progress=False)
        check_request(path, chosen, request)

        def do() -> Message:
            """Write it; the face in the window stays as it is."""
            clip = record(self._played(), _another(self._session.scene), progress=False)
            write(clip, path, chosen, request)
            return f"{path}: {chosen.title}, {counted(clip.frame_count, 'frame')} written"

        self._announced = do
        return f"writing {path.name} ..."

    def do_announced(self) -> Message:
        """Write what was announced."""
        task, self._announced = self._announced, None
        return None if task is None else task()

    def _played(self) -> Script:
        """The script, or the face as it is where that says nothing."""
        session = self._session
        if session.script.posed_names or session.script.tracks:
            return session.script
        return pose_script(session.current, title="pose", scene=session.script.scene)


def _another(scene: Scene) -> Scene:
    """A scene like this one, with the same head."""
    return FaceScene(scene.head) if isinstance(scene, FaceScene) else build_scene(scene.name)
