"""`python -m tests.docs.language [--tighten]`: long sentences of pages and docstrings, and numbers in prose.

Prints the worst pages and their longest sentences, and all long sentences of docstrings. `--tighten` lowers
the table language.yaml to what is measured; it never raises a value.
"""

import ast
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]
TABLE = Path(__file__).with_name("language.yaml")
LONGEST = 25
"""Words of a sentence."""
ROOMS = ("bus", "boards", "plant", "calibration", "host", "scenarios", "schmidt.py")
"""Whose docstrings are read."""
_CODE = re.compile(r"^(```|~~~).*?^\1|<!--.*?-->|^\|[-:| ]+\|$", re.DOTALL | re.MULTILINE)
_ROW = re.compile(r"^\|.*$", re.MULTILINE)
_BREAK = re.compile(r"\n\s*\n|\n(?=\s*(?:[-*+]|\d+\.) )|\n(?=#)|(?<=\|)\n| \| ")
_END = re.compile(r"(?<=[.!?])[)\"'*_]*\s+(?=[^a-z])")
_NUMBER = re.compile(r"(?<!\w)[−±-]?\d[\d.,\u202f\u00a0]*")
_FORMULA = re.compile(r"\$\$.*?\$\$|\$[^$\n]+\$", re.DOTALL)
"""TeX in a page: one word of a sentence."""
_DATE = re.compile(r"\b\d{4}-\d\d-\d\d\b")
"""No figure: a page of results bears one."""
_QUOTE = re.compile(r"^>.*$", re.MULTILINE)
"""The words of others, which nobody here may shorten."""
_DOCSTRING_END = re.compile(r"(?<=[.:;!?])\s+|\n\n")
_DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A page: sentences over 25 words, and numbers per 100 words of its prose."""

    long: tuple[str, ...]
    numbers: float


def pages() -> dict[str, Path]:
    """Every page of the documentation, by its path in the repository."""
    found = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    return {path.relative_to(ROOT).as_posix(): path for path in sorted(found)}


def sentences(text: str) -> Iterator[str]:
    """Sentences of a page, those in cells of tables too; headings, code and quotes are none."""
    text = _FORMULA.sub("Formula", _CODE.sub("", text))
    for block in _BREAK.split(_QUOTE.sub("", text)):
        lines = block.strip("\n").splitlines()
        if all(line.startswith("    ") for line in lines) and not re.match(r" +[-*\d]", block):
            continue  # indented code
        plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", block)
        plain = re.sub(r"`[^`]*`", "Code", plain)  # may begin a sentence
        plain = re.sub(r"^\s*(?:[-*+>|]|\d+\.)\s+|[*_]{2}", "", plain).strip(" |\n")
        if plain and not plain.startswith("#"):
            yield from (" ".join(part.split()) for part in _END.split(plain) if part.strip())


def words(sentence: str) -> int:
    """Words: what stands between spaces and has a letter or a digit."""
    return sum(1 for word in sentence.split() if re.search(r"\w", word))


def measured(text: str) -> Measured:
    """A page's text, measured."""
    prose = list(sentences(_ROW.sub("", text)))
    total = sum(map(words, prose))
    numbers = sum(len(_NUMBER.findall(_DATE.sub("", sentence))) for sentence in prose)
    return Measured(
        long=tuple(sentence for sentence in sentences(text) if words(sentence) > LONGEST),
        numbers=round(100 * numbers / max(total, 100), 1),
    )


def long_docstrings(source: str) -> list[str]:
    """Sentences over 25 words in the docstrings of a Python file's text.

    A colon, a semicolon or an empty line ends one, too. A word is what stands between spaces.
    """
    found = (ast.get_docstring(n) or "" for n in ast.walk(ast.parse(source)) if isinstance(n, _DOCUMENTED))
    parts = (" ".join(part.split()) for text in found for part in _DOCSTRING_END.split(text))
    return [part for part in parts if len(part.split()) > LONGEST]


def room_docstrings(room: str) -> list[str]:
    """Sentences over 25 words in the docstrings of a room, each with its file."""
    root = ROOT / room
    return [
        f"{path.relative_to(ROOT).as_posix()}: {sentence}"
        for path in (sorted(root.rglob("*.py")) if root.is_dir() else [root])
        for sentence in long_docstrings(path.read_text(encoding="utf-8"))
    ]


def allowed() -> dict[str, dict[str, float]]:
    """The table: page to the allowed count of long sentences and of numbers per 100 words."""
    table: dict[str, dict[str, float]] = yaml.safe_load(TABLE.read_text(encoding="utf-8"))
    return table


def tightened(table: dict[str, dict[str, float]], now: dict[str, Measured]) -> dict[str, dict[str, float]]:
    """The table with lower values where a page is better, without pages that are gone or need no line."""
    limit = table["any other page"]
    lower = {
        name: {
            "long": min(row["long"], len(now[name].long)),
            "numbers": min(row["numbers"], now[name].numbers),
        }
        for name, row in table.items()
        if name in now
    }
    kept = {name: row for name, row in lower.items() if any(row[key] > limit[key] for key in limit)}
    return {"any other page": limit, **kept}


def written(table: dict[str, dict[str, float]]) -> str:
    """The file language.yaml."""
    head = TABLE.read_text(encoding="utf-8").split("any other page")[0]
    return head + "".join(
        f"{name}: {{long: {row['long']}, numbers: {row['numbers']:g}}}\n" for name, row in table.items()
    )


def main(arguments: list[str]) -> int:
    """Print the worst; with --tighten write the table."""
    now = {name: measured(path.read_text(encoding="utf-8")) for name, path in pages().items()}
    for name, page in sorted(now.items(), key=lambda item: -len(item[1].long))[:10]:
        rate = f"{page.numbers:4.1f} numbers per 100 words"
        print(f"{len(page.long):4d} sentences over {LONGEST} words, {rate}  {name}")
    longest = sorted(((words(s), name, s) for name, page in now.items() for s in page.long), reverse=True)[:5]
    for count, name, sentence in longest:
        print(f"\n{name}, {count} words: {sentence}")
    for sentence in (sentence for room in ROOMS for sentence in room_docstrings(room)):
        print(f"\n{sentence}")
    if "--tighten" in arguments:
        TABLE.write_text(written(tightened(allowed(), now)), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
