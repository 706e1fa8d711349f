"""What the site has beside docs/: pages of the root, sources of examples, the command line.

MkDocs calls these functions (mkdocs.yml, hooks). Pages stay as they are read in the repository,
with links like `../examples/case1.toml`; here such a link leads to a page that shows the file.
"""

import posixpath
import re
from pathlib import Path

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
ROOT_PAGES = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "README.md": "index.md",
}
"""pages beside docs/, and their names on the site"""
SOURCES = ("examples/*.toml", "examples/*.py", "examples/*.csv", "meshes/*/*.toml", "meshes/*/*.py")
"""files that pages lead to, shown as code"""
LINK = re.compile(r"(?<=\]\()(?P<file>[^)\s#:]+)(?P<anchor>#[^)\s]*)?(?=\))")


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages of the root, and one for each source."""
    for name, page in ROOT_PAGES.items():
        if page != "index.md":
            files.append(File.generated(config, page, content=(ROOT / name).read_text("utf-8")))
    for path in sources():
        files.append(File.generated(config, _page_of_source(path), content=shown(path)))
    return files


def sources() -> list[str]:
    """Paths of all sources, from the root."""
    found = [path for pattern in SOURCES for path in ROOT.glob(pattern)]
    return sorted(path.relative_to(ROOT).as_posix() for path in found)


def shown(path: str) -> str:
    """A page with the text of a source."""
    language = {".toml": "toml", ".py": "python"}.get(Path(path).suffix, "text")
    hidden = "---\nsearch:\n  exclude: true\n---\n"
    return f"{hidden}# {path}\n\n````{language}\n{(ROOT / path).read_text('utf-8')}````\n"


def _page_of_source(path: str) -> str:
    return f"sources/{path}.md"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Links of the repository as links of the site."""
    place = page.file.src_uri
    if place.startswith("sources/"):
        return markdown
    origin = {site: name for name, site in ROOT_PAGES.items()}.get(place, f"docs/{place}")
    if place == "index.md":
        origin = "docs/index.md"
    return LINK.sub(lambda link: _led(link, origin, place), markdown)


def _led(link: re.Match[str], origin: str, place: str) -> str:
    """A link of a page that stands at origin in the repository, and at place on the site."""
    target = posixpath.normpath(posixpath.join(posixpath.dirname(origin), link["file"]))
    if target in ROOT_PAGES:
        target = ROOT_PAGES[target]
    elif target.startswith("docs/"):
        target = target.removeprefix("docs/")
    elif target in sources():
        target = _page_of_source(target)
    else:
        return link[0]
    here = posixpath.dirname(place) or "."
    return posixpath.relpath(target, here) + (link["anchor"] or "")
