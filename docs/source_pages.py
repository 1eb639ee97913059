"""A hook of mkdocs: the site has a page with the code of each file to which its pages link.

On a code host, the link `../refine/mesh/normals.py` leads to the file. The site contains only what
lies in docs/, and refuses links out of it, so there the link leads to the page of the file.
"""

import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files, InclusionLevel
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
CODE_LINK = re.compile(r"\]\(\.\./([\w/]+)\.py\)")  # in a page directly in docs/


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add a page for each file of code to which a page links."""
    texts = [file.content_string for file in files.documentation_pages()]
    names = {name for text in texts for name in CODE_LINK.findall(text)}
    for name in sorted(names):
        code = (ROOT / f"{name}.py").read_text("utf-8")
        # The search of the site is for prose.
        head = f"---\nsearch: {{exclude: true}}\n---\n# {name}.py\n\n"
        text = f'{head}````python linenums="1"\n{code}````\n'
        files.append(
            File.generated(
                config, f"code/{name}.md", content=text, inclusion=InclusionLevel.NOT_IN_NAV
            )
        )
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Let links to files of code lead to their pages."""
    return CODE_LINK.sub(r"](code/\1.md)", markdown)
