"""What the site has beside docs/: pages of the root, sources of examples, the command line.

MkDocs calls these functions (mkdocs.yml, hooks). Pages stay as they are read in the repository,
with links like `../examples/case1.toml`; here such a link leads to a page that shows the file.
"""

import posixpath
import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
ROOT_PAGES = {
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
    "SECURITY.md": "security.md",
    "README.md": "index.md",
}
"""pages beside docs/, and their names on the site"""
SOURCES = (
    "notebooks/*.py",
    "examples/*.toml",
    "examples/*.py",
    "examples/*.csv",
    "meshes/*/*.toml",
    "meshes/*/*.py",
    "schemas/*.json",
)
"""files that pages lead to, shown as code"""
COMMANDS = "<!-- commands -->"
"""place of the command line on its page"""
LINK = re.compile(r"(?<=\]\()(?P<file>[^)\s#:]+)(?P<anchor>#[^)\s]*)?(?=\))")


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Pages that the navigation does not name stand at the end of the reference."""
    text = (ROOT / "mkdocs.yml").read_text("utf-8")
    named = set(re.findall(r"[\w/-]+\.md", text))
    found = sorted(path.relative_to(DOCS).as_posix() for path in DOCS.rglob("*.md"))
    reference = next(part["Reference"] for part in config.nav if "Reference" in part)
    reference.extend(page for page in found if page not in named)
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages of the root, and one for each source."""
    for name, page in ROOT_PAGES.items():
        if page != "index.md":
            files.append(File.generated(config, page, content=(ROOT / name).read_text("utf-8")))
    for path in sources():
        files.append(File.generated(config, _page_of_source(path), content=shown(path)))
    for folder in folders():
        files.append(File.generated(config, f"sources/{folder}/index.md", content=listed(folder)))
    return files


def sources() -> list[str]:
    """Paths of all sources, from the root."""
    found = [path for pattern in SOURCES for path in ROOT.glob(pattern)]
    return sorted(path.relative_to(ROOT).as_posix() for path in found)


def folders() -> list[str]:
    """Folders of sources, which pages may lead to as well."""
    return sorted({posixpath.dirname(path) for path in sources()})


def listed(folder: str) -> str:
    """A page with the sources in a folder."""
    names = [Path(path).name for path in sources() if posixpath.dirname(path) == folder]
    return "\n".join([f"# {folder}", "", *(f"- [{name}]({name}.md)" for name in names), ""])


def shown(path: str) -> str:
    """A page with the text of a source."""
    language = {".toml": "toml", ".py": "python", ".json": "json"}.get(Path(path).suffix, "text")
    hidden = "---\nsearch:\n  exclude: true\n---\n"
    return f"{hidden}# {path}\n\n````{language}\n{(ROOT / path).read_text('utf-8')}````\n"


def _page_of_source(path: str) -> str:
    return f"sources/{path}.md"


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Links of the repository as links of the site."""
    place = page.file.src_uri
    if place == "command-line.md":
        markdown = markdown.replace(COMMANDS, commands())
    if place.startswith("sources/"):
        return markdown
    if place == "gallery.md":
        markdown = cards(markdown)
        page.meta["hide"] = ["navigation", "toc"]  # room for films of 480 px side by side
    beside = {site: name for name, site in ROOT_PAGES.items() if site != "index.md"}
    origin = beside.get(place, f"docs/{place}")
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
    elif target in folders():
        target = f"sources/{target}/index.md"
    else:
        return link[0]
    here = posixpath.dirname(place) or "."
    return posixpath.relpath(target, here) + (link["anchor"] or "")


def cards(markdown: str) -> str:
    """The tables of the gallery as cards: a film, or the picture where there is none, what it is,
    and how it is made.
    """
    return re.sub(r"^\| film .*\n\|[-|]+\n((?:\|.*\n?)+)", _cards, markdown, flags=re.M)


def _cards(table: re.Match[str]) -> str:
    found = ['<div class="grid cards" markdown>', ""]
    for row in table[1].splitlines():
        film, picture, example, command, seconds = (
            cell.strip() for cell in re.split(r"(?<!\\)\|", row.strip().strip("|"))
        )
        pictures = [*re.findall(r"!\[[^]]*\]\([^)]*\)", film), *([picture] if picture else [])]
        shown = "\n    ".join(pictures)
        found += [f"-   {shown}", "", f"    {example}", "", f"    {command} · {seconds} s", ""]
    return "\n".join([*found, "</div>", ""])


def on_post_build(config: MkDocsConfig) -> None:
    """Links of llms.txt lead to pages of the site, as all others do."""
    path = Path(config.site_dir) / "llms.txt"
    path.write_text(path.read_text("utf-8").replace(".md)", ".html)"), encoding="utf-8")


def commands() -> str:
    """The command line, from the application itself: one section a command."""
    from duhamel.cli import app
    from typer.main import get_command

    group: Any = get_command(app)
    names = group.list_commands(None)
    return "\n\n".join(_command(name, group.get_command(None, name)) for name in names)


def _command(name: str, command: Any) -> str:
    lines = [f"## duhamel {name}", command.help or "", f"    {_usage(name, command)}"]
    rows = [_row(parameter) for parameter in command.params if not parameter.hidden]
    if rows:
        lines.append("\n".join(["| | | |", "|---|---|---|", *rows]))
    return "\n\n".join(lines)


def _usage(name: str, command: Any) -> str:
    asked = [p for p in command.params if p.param_type_name == "argument"]
    words = [_value(p) if p.required else f"[{_value(p)}]" for p in asked]
    return " ".join(["duhamel", name, "[OPTIONS]", *words])


def _row(parameter: Any) -> str:
    """A row of the table of a command: names, what stands for the value, help and default."""
    is_option = parameter.param_type_name == "option"
    names = ", ".join(f"`{name}`" for name in [*parameter.opts, *parameter.secondary_opts])
    value = "" if getattr(parameter, "is_flag", False) else f"`{_value(parameter)}`"
    default = parameter.default
    shown = f" Unless given: {default}." if is_option and default not in (None, False, ()) else ""
    text = f"{getattr(parameter, 'help', None) or ''}{shown}".replace("|", "\\|")
    return f"| {names if is_option else value} | {value if is_option else ''} | {text} |"


def _value(parameter: Any) -> str:
    """The word that stands for the value of a parameter."""
    return (parameter.metavar or "VALUE") + ("..." if parameter.nargs == -1 else "")
