"""Hooks of the documentation site: pages outside docs/, formulas as MathML, diagrams by a local Mermaid.

The Markdown links relative to the repository, as a forge shows it. Here a link to a page goes to that page of
the site, a link to another file to a copy of that file, a link to a folder of source becomes plain text.
"""

import html
import importlib.util
import posixpath
import re
from pathlib import Path

from latex2mathml.converter import convert
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files
from mkdocs.structure.pages import Page

ROOT = Path(__file__).resolve().parents[1]
OUTSIDE = {
    f"{name}.md": f"{folder}{name.lower()}.md"
    for name, folder in (
        ("FIDELITY", "reference/"),
        ("ARCHITECTURE", "concepts/"),
        ("CHANGELOG", ""),
        ("CONTRIBUTING", "guides/"),
        ("SECURITY", "reference/"),
    )
}
"""Pages at the root of the repository and their place on the site."""
MERMAID = "assets/mermaid"
"""Folder of the site with the scripts that draw diagrams."""
ELSEWHERE = {"README.md": "index.md"}
"""Files whose links go to a page that says the same."""
_LINK = re.compile(r"(?P<code>```.*?```|`[^`\n]*`)|(?P<text>\[[^\]]*\])\((?P<target>[^)\s]+)\)", re.DOTALL)
_FORMULA = re.compile(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', re.DOTALL)


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that stand at the root of the repository."""
    for name, place in OUTSIDE.items():
        if (ROOT / name).exists():
            files.append(File.generated(config, place, abs_src_path=str(ROOT / name)))
    return files


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn links between files of the repository into links of the site."""
    if "```mermaid" in markdown:
        add_mermaid(config, files)
    source = next((name for name, place in OUTSIDE.items() if place == page.file.src_uri), None)
    return relink(markdown, source or f"docs/{page.file.src_uri}", page.file.src_uri, config, files)


def add_mermaid(config: MkDocsConfig, files: Files) -> None:
    """Copy NiceGUI's Mermaid to the site, once. Raises FileNotFoundError where NiceGUI keeps it elsewhere."""
    if files.get_file_from_path(f"{MERMAID}/index.js") is not None:
        return
    found = importlib.util.find_spec("nicegui")
    folder = Path(str(found and found.origin)).parent / "elements" / "mermaid" / "dist"
    if not (folder / "index.js").exists():
        raise FileNotFoundError(f"{folder}: no Mermaid there; name its place in docs/hooks.py")
    for script in sorted(folder.glob("*.js")):
        files.append(File.generated(config, f"{MERMAID}/{script.name}", abs_src_path=str(script)))


def relink(markdown: str, source: str, place: str, config: MkDocsConfig, files: Files) -> str:
    """Markdown of the file `source` of the repository with links that hold at `place` of the site."""
    here = posixpath.dirname(place) or "."

    def changed(found: re.Match[str]) -> str:
        target, text = found["target"], found["text"]
        if found["code"] or re.match(r"[a-z]+:|[#/]", target):
            return found[0]
        name, mark, anchor = target.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(source), name))
        if path.startswith("..") or not (ROOT / path).exists():
            return found[0]  # strict mode reports it
        if (ROOT / path).is_dir() and (ROOT / path / "README.md").exists():
            path = posixpath.join(path, "README.md")
        there = (OUTSIDE | ELSEWHERE).get(path) or path.removeprefix("docs/")
        if path not in OUTSIDE | ELSEWHERE and not path.startswith("docs/"):
            if (ROOT / path).is_dir():
                return text[1:-1]
            there = f"files/{path}"
        if files.get_file_from_path(there) is None and there.startswith("files/"):
            files.append(File.generated(config, there, abs_src_path=str(ROOT / path)))
        return f"{text}({posixpath.relpath(there, here)}{mark}{anchor})"

    return _LINK.sub(changed, markdown)


def on_page_content(content: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Turn formulas in TeX into MathML, which browsers show by themselves."""
    return _FORMULA.sub(
        lambda found: convert(html.unescape(found[3]), display="block" if found[2] == "[" else "inline"),
        content,
    )
