"""The manual in the window: the pages of docs/ as one document, with contents and a search.

The pages are installed with the program, so no network is needed. Pictures are left out.
"""

from __future__ import annotations

import posixpath
import re
import unicodedata
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from importlib import metadata
from pathlib import Path

import imgui_bundle
from imgui_bundle import imgui, rich_md

import risorius

from ...errors import UserError
from ..interface.gui import Gui, em
from ..messages import Message

FIRST_PAGE = "viewer.md"


class Manual:
    """A window with a text over the picture; it can be moved, and Escape closes it."""

    def __init__(self, gui: Gui) -> None:
        self._gui = gui
        self.is_open = False
        self._wants_focus = False  # whether the next frame gives it the focus
        self._title = ""
        self._text = ""
        self._pages = ""
        self._context: rich_md.Context | None = None

    def read(self) -> Message:
        """Show the pages; raises UserError if they are missing."""
        self._pages = self._pages or one_document(pages())
        self.show("Manual", self._pages)
        return None

    def show(self, title: str, text: str) -> None:
        """Show a text in Markdown."""
        self._title = title
        self._text = text
        self.is_open = True
        self._wants_focus = True

    def draw(self, area: tuple[float, float, float, float]) -> None:
        """Draw the text. area: left, top, width and height of the picture [window units]."""
        self._gui.is_reading = False
        if not self.is_open:
            return
        if self._context is None:
            self._context = rich_md.create_context(_options())
        left, top, width, height = area
        margin = em(0.8)
        room = width - 2.0 * margin, height - 2.0 * margin
        readable_width = em(66.0)
        imgui.set_next_window_pos((left + margin, top + margin), imgui.Cond_.appearing)
        imgui.set_next_window_size((min(room[0], readable_width), room[1]), imgui.Cond_.appearing)
        is_visible, is_open = imgui.begin(self._title, True, imgui.WindowFlags_.no_collapse)
        self.is_open = bool(is_open)
        if is_visible:
            options = rich_md.DocumentOptions()
            options.scroll_animation = rich_md.ScrollAnimation.never  # the window may sleep
            if self._wants_focus:
                imgui.set_next_window_focus()
                self._wants_focus = False
            rich_md.render_document(self._title, self._text, options=options)
        is_focused = imgui.is_window_focused(imgui.FocusedFlags_.child_windows)
        self._gui.is_reading = is_focused and self.is_open
        is_writing = imgui.get_io().want_text_input  # Escape ends a search first
        if is_focused and not is_writing and imgui.is_key_pressed(imgui.Key.escape):
            self.is_open = False
        imgui.end()

    def close(self) -> None:
        """Release the resources of the text; the GUI must still exist."""
        if self._context is not None:
            rich_md.destroy_context(self._context)
            self._context = None


def _options() -> rich_md.MarkdownOptions:
    """Return options of the text, with a second font for arrows and other missing characters."""
    rich_md.set_assets_folder(str(Path(imgui_bundle.__file__).parent / "assets"))
    options = rich_md.MarkdownOptions()
    options.font_options.merge_fonts = ["fonts/Inconsolata-Medium.ttf"]
    return options


def pages() -> dict[str, str]:
    """Return the texts of the pages by their names in docs/, in reading order.

    UserError if the pages are neither in a checkout nor installed.
    """
    folder = _folder()
    names = [path.relative_to(folder).as_posix() for path in sorted(folder.glob("**/*.md"))]
    is_left_out = ("reference/", "gallery")  # pages only for the site, and the page of pictures
    present = [name for name in names if not name.startswith(is_left_out)]
    start = (folder / "index.md").read_text(encoding="utf-8")
    linked = re.findall(r"\]\(([\w/]+\.md)", start)
    order = [name for name in (FIRST_PAGE, "index.md", *linked, *present) if name in present]
    return {name: (folder / name).read_text(encoding="utf-8") for name in dict.fromkeys(order)}


def _folder() -> Path:
    """Return the folder of the pages: docs/ in a checkout, otherwise the installed folder."""
    checkout = Path(risorius.__file__).resolve().parents[1] / "docs"
    if (checkout / FIRST_PAGE).is_file():
        return checkout
    for file in metadata.files("risorius") or ():
        if file.parts[-4:] == ("share", "doc", "risorius", FIRST_PAGE):
            return Path(str(file.locate())).resolve().parent
    raise UserError("the manual is not installed: docs/viewer.md of the source has it")


def one_document(texts: Mapping[str, str]) -> str:
    """Join the pages to one document, in which links between pages become links to headings.

    texts: Markdown, by the names of the pages.
    """
    places: dict[tuple[str, str], str] = {}  # name of a heading in the document, by page and anchor
    counts: Counter[str] = Counter()
    for page, text in texts.items():
        for number, heading in enumerate(_headings(text)):
            slug = slug_of(heading)
            again = counts[slug]
            counts[slug] += 1
            place = f"{slug}-{again}" if again else slug
            places[page, _anchor(heading)] = place
            if number == 0:
                places[page, ""] = place
    return "\n\n".join(_linked(text, page, places) for page, text in texts.items())


def _linked(text: str, page: str, places: Mapping[tuple[str, str], str]) -> str:
    """Return a page without pictures, with links to headings of the document."""

    def link(found: re.Match[str]) -> str:
        """Return the link within the document, or only the words of a link out of it."""
        words = found[1]
        target = found[2]
        if "://" in target:
            return found[0]
        name, _, anchor = target.partition("#")
        other = posixpath.normpath(posixpath.join(posixpath.dirname(page), name))
        place = places.get((other if name else page, anchor))
        return f"[{words}](#{place})" if place is not None else words

    without_pictures = re.sub(r"!\[[^\]]*\]\([^)]*\)", "", text)
    return re.sub(r"\[([^\]]*)\]\(([^)\s]+)\)", link, without_pictures)


def _headings(text: str) -> Iterator[str]:
    """Yield the headings of a page; lines in blocks of code do not count."""
    is_code = False
    for line in text.splitlines():
        if line.lstrip().startswith("```"):
            is_code = not is_code
        elif not is_code and (found := re.match(r"#{1,6} (.+)", line)):
            yield found[1]


def slug_of(heading: str) -> str:
    """Return a heading's name in the document: lower case, hyphens for spaces, no other marks."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def _anchor(heading: str) -> str:
    """Return a heading's name in links between pages: its slug in ASCII, with single hyphens."""
    plain = unicodedata.normalize("NFKD", heading).encode("ascii", "ignore").decode("ascii")
    return re.sub(r"-+", "-", slug_of(plain))


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown."""
    titles = tuple(head)
    lines = (titles, ("---",) * len(titles), *rows)
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)
