"""Counts of wording that may only fall: strict sentences, messages, numbers in a sentence, private words.

`python -m tests.docs.wording [--all] [--tighten]` prints the counts, and with --all every finding.
`--tighten` lowers the table wording.yaml to what is measured; it never raises a value.
"""

import ast
import json
import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import yaml

from tests.docs import language
from tests.docs.language import LONGEST, ROOMS, ROOT

TABLE = Path(__file__).with_name("wording.yaml")
READING_PATH = ("README.md", "docs/index.md", "docs/guides/", "docs/concepts/")
PRIVATE = (
    *("told", "mended", "earned", "believed", "taken away", "comes along", "come along", "of ours"),
    *("looked at and refused", "run again", "is left over", "gives away"),
)
"""Words of the makers. The field's terms: reported, corrected, accepted, removed, built-in, replayed."""
_PRIVATE = re.compile(rf"\b(?:{'|'.join(PRIVATE)})\b", re.IGNORECASE)
_STRICT_END = re.compile(r"(?<=[.!?])[)\"'*_]*\s+|\n\s*\n")
_NUMBER = re.compile(r"(?<![\w.])[−±+-]?\d[\d.,:\u202f\u00a0]*(?!\w)")
_ONE = re.compile(r"\b\d+\(\d+\) \d+|\b[\d.]+ (?:of|to|and|or|×) [\d.]+")
"""One figure in several numbers: 52(8) 081607, 10 of 15, 1 to 3."""
_NONE = re.compile(r"\b\d{4}-\d\d-\d\d\b|\([^)]*\)")
"""No figure: a day, and what stands in brackets."""
_TAG = re.compile(r"\{[{%#].*?[}%#]\}|<style.*?</style>|<[^>]*>", re.DOTALL)


def _sentences(text: str) -> list[str]:
    return [" ".join(part.split()) for part in _STRICT_END.split(text) if part.strip()]


def long_sentences(text: str) -> list[str]:
    """Sentences over 25 words; only a full stop, !, ? or an empty line ends one."""
    return [part for part in _sentences(text) if len(part.split()) > LONGEST]


def _docstring_nodes(tree: ast.AST) -> Iterator[ast.Constant]:
    """Docstrings, those of attributes too: every string that is a statement."""
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Expr)
            and isinstance(node.value, ast.Constant)
            and isinstance(node.value.value, str)
        ):
            yield node.value


def docstrings(source: str) -> list[str]:
    """All docstrings of a Python file's text."""
    return [str(node.value) for node in _docstring_nodes(ast.parse(source))]


def messages(source: str) -> list[str]:
    """All other strings of a Python file's text; a value in an f-string counts as one word."""
    tree = ast.parse(source)
    inside = {id(node) for node in _docstring_nodes(tree)}
    found = []
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            inside.update(id(value) for value in ast.walk(node) if value is not node)
            found.append(
                "".join(
                    str(value.value) if isinstance(value, ast.Constant) else "value" for value in node.values
                )
            )
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in inside:
            found.append(node.value)
    return [text for text in found if " " in text]


def _sources(room: str) -> Iterator[tuple[str, str]]:
    root = ROOT / room
    for path in sorted(root.rglob("*.py")) if root.is_dir() else [root]:
        if "library" not in path.parts:
            yield path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")


def _in_sources(room: str, found: Callable[[str], list[str]]) -> list[str]:
    return [f"{name}: {text}" for name, source in _sources(room) for text in found(source)]


def _long_docstrings(source: str) -> list[str]:
    return [part for text in docstrings(source) for part in long_sentences(text)]


def _long_messages(source: str) -> list[str]:
    return [part for text in messages(source) for part in long_sentences(text)]


def _whats(source: str) -> list[str]:
    return [text.split("\n")[0] for text in docstrings(source) if re.match(r"What\b", text.strip())]


def private(text: str) -> list[str]:
    """Private words of a text."""
    return _PRIVATE.findall(text)


def _private_messages(source: str) -> list[str]:
    return [text for text in messages(source) if private(text)]


def _count(sentence: str) -> int:
    return len(_NUMBER.findall(_NONE.sub("", _ONE.sub("1", sentence))))


def several_numbers(text: str) -> list[str]:
    """Sentences of a page's prose with more than one number."""
    prose = re.sub(r"^\|.*$", "", text, flags=re.MULTILINE)
    return [s for s in language.sentences(prose) if _count(s) > 1]


def _descriptions(schema: object) -> Iterator[str]:
    if isinstance(schema, dict):
        for key, value in schema.items():
            if key == "description" and isinstance(value, str):
                yield value
            else:
                yield from _descriptions(value)
    elif isinstance(schema, list):
        for each in schema:
            yield from _descriptions(each)


def _other_texts(room: str) -> list[str]:
    """Long sentences in descriptions of schemas and in templates of reports."""
    root = ROOT / room
    texts: list[tuple[Path, str]] = []
    for path in sorted(root.rglob("*.json")) if root.is_dir() else []:
        schema = json.loads(path.read_text(encoding="utf-8"))
        texts += [(path, text) for text in _descriptions(schema)]
    for path in sorted(root.rglob("*.j2")) if root.is_dir() else []:
        texts.append((path, _TAG.sub("\n\n", path.read_text(encoding="utf-8"))))
    return [f"{path.relative_to(ROOT)}: {part}" for path, text in texts for part in long_sentences(text)]


def _pages(found: Callable[[str], list[str]], *begin: str) -> list[str]:
    return [
        f"{name}: {text}"
        for name, path in language.pages().items()
        if name.startswith(begin)
        for text in found(path.read_text(encoding="utf-8"))
    ]


def findings() -> dict[str, list[str]]:
    """Every measure by its name: what it finds."""
    rooms: dict[str, Callable[[str], list[str]]] = {
        "long sentences of docstrings": _long_docstrings,
        "long sentences of messages": _long_messages,
        "docstrings that begin with What": _whats,
        "private words in messages": _private_messages,
    }
    found = {
        f"{name}, {room}": _in_sources(room, measure) for name, measure in rooms.items() for room in ROOMS
    }
    found |= {f"long sentences of schemas and templates, {room}": _other_texts(room) for room in ROOMS}
    found["sentences of the reading path with several numbers"] = _pages(several_numbers, *READING_PATH)
    found["private words in pages"] = _pages(
        private, "README.md", "docs/", "ARCHITECTURE.md", "CONTRIBUTING.md"
    )
    return {name: texts for name, texts in found.items() if texts}


def allowed() -> dict[str, int]:
    """The table: measure to the count that is allowed. What has no row is not allowed at all."""
    table: dict[str, int] = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    return table


def main(arguments: list[str]) -> int:
    """Print the counts; with --all the findings; with --tighten write the table."""
    found = findings()
    table = allowed()
    for name, texts in found.items():
        print(f"{len(texts):4d} of {table.get(name, 0):4d} allowed: {name}")
        for text in texts if "--all" in arguments else []:
            print(f"       {text}")
    if "--tighten" in arguments:
        head = TABLE.read_text(encoding="utf-8").split("\n\n")[0]
        kept = {name: min(most, len(found.get(name, []))) for name, most in table.items()}
        rows = [f"{name}: {count}" for name, count in kept.items() if count]
        TABLE.write_text("\n".join([head, "", *rows]) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
