"""Small pieces of Markdown that the generated pages share."""

import re
from collections.abc import Iterable

MADE = "Made by `python -m docs.generate` from {source}; change that, not this page.\n"
"""Second paragraph of a generated page."""


def cell(text: str) -> str:
    """Text for a cell of a table: one line, without a bar that would end it."""
    return " ".join(text.split()).replace("|", "\\|")


def linked(text: str) -> str:
    """A cell in which pages, `docs/reference/faults.md`, are links as from docs/reference."""
    return re.sub(r"docs/((?:\w+/)*([\w-]+)\.md)", r"[\2](../\1)", cell(text))


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """A table of Markdown with the lines around it empty."""
    titles = list(head)
    lines = [titles, ["---"] * len(titles), *rows]
    return "\n" + "".join("| " + " | ".join(each) + " |\n" for each in lines).replace("|  |", "| |")


_NAMED = re.compile(r"(?:^|(?<=[.;] ))(?!e\.g)([a-z]\w*(?:, [a-z]\w*)*): ")


def prose(docstring: str) -> str:
    """A docstring's paragraphs, each on one line; `name: what it is` becomes an item of a list."""
    paragraphs = re.split(r"\n\s*\n", docstring.strip())
    return "\n\n".join(_items(" ".join(each.split()).replace("``", "`")) for each in paragraphs)


def _items(paragraph: str) -> str:
    lead, *rest = _NAMED.split(paragraph)
    if not rest:
        return paragraph
    items = (f"- `{name}`: {text.strip()}" for name, text in zip(rest[::2], rest[1::2], strict=True))
    return f"{lead.strip()}\n\n".lstrip() + "\n".join(items)
