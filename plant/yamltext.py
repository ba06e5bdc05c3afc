"""Text files from outside, and YAML in them, before anything is built from it.

An alias stands for a whole tree, so a few lines can name more values than a machine holds. Brackets can be
nested deeper than the parser's stack. Both are seen in the event stream, which costs neither.
"""

import re
import stat
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import yaml

MAX_BYTES = 4_000_000
"""The largest file of the project has 30 kB."""
MAX_DEPTH = 50
MAX_VALUES = 100_000
MOST_TOLD = 20
"""Mistakes of one file that are told: a screen. ASSUMPTION."""
_TOO_LONG = re.compile(r"[-+]?(0[xb])?[0-9a-fA-F_:]{251,}")
"""A whole number that no floating-point number may hold: 250 hexadecimal digits are 1e301."""


class TextError(ValueError):
    """A file or a text that cannot be used; `what` says why, without the file's name."""

    def __init__(self, what: str, line: int | None = None) -> None:
        self.what = what
        self.line = line
        super().__init__(what if line is None else f"line {line}: {what}")


def beside(first: Exception, others: Sequence[str], place: str) -> Exception:
    """`first` with a file's other mistakes as its notes: a screen of them, and how many more there are."""
    for text in others[: MOST_TOLD - 1]:
        first.add_note(text)
    if len(others) >= MOST_TOLD:
        first.add_note(f"{place}: and {len(others) - MOST_TOLD + 1} mistakes more")
    return first


def nearest(word: str, words: Iterable[str]) -> str:
    """A hint that names the nearest valid word, or all of them when none is near."""
    known = {each.lower(): each for each in words}
    near = get_close_matches(word.lower(), known, 1, 0.5)
    if near:
        return f"did you mean {known[near[0]]!r}?"
    return f"use one of {', '.join(known.values())}" if known else "none is allowed here"


def check_regular(path: Path) -> None:
    """Raise TextError for what is there and is no regular file: a pipe or a device may never end."""
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return
    except OSError as error:
        raise TextError(f"cannot be read: {error.strerror}") from None
    except ValueError:
        raise TextError("no file can have this name") from None
    if not stat.S_ISREG(mode):
        raise TextError("cannot be read: it is no regular file")


def read_text(path: Path, limit: int = MAX_BYTES) -> str:
    """The text of a regular file of at most `limit` bytes; raises TextError, FileNotFoundError.

    A pipe or a device is refused: it may never end, or never begin.
    """
    check_regular(path)
    try:
        with path.open("rb") as file:
            data = file.read(limit + 1)
    except FileNotFoundError:
        raise
    except OSError as error:
        raise TextError(f"cannot be read: {error.strerror}") from None
    if len(data) > limit:
        raise TextError(f"is longer than {limit} bytes")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise TextError("cannot be read: it is not UTF-8 text", line) from None


def check_yaml(text: str) -> None:
    """Raise TextError for YAML that is broken, nested too deeply, has too many aliases or a key twice."""
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        _check_events(yaml.parse(text, Loader=loader))
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        colon = " (a text with a colon needs quotes)" if "mapping values" in (error.problem or "") else ""
        raise TextError(f"is not YAML: {error.problem}{colon}", line) from None
    except (yaml.YAMLError, OverflowError, ValueError, RecursionError) as error:
        if isinstance(error, TextError):
            raise
        raise TextError(f"is not YAML: {str(error).splitlines()[0]}", 1) from None


@dataclass
class _Open:
    """A collection that is open: its anchor, how many values stand before it, a mapping's keys by line."""

    anchor: str | None
    before: int
    keys: dict[str, int] | None
    nodes: int = 0

    def take(self, event: yaml.NodeEvent, line: int) -> None:
        """The next node inside, every other one a mapping's key; raises TextError for a key that is there."""
        if self.keys is not None and self.nodes % 2 == 0 and isinstance(event, yaml.ScalarEvent):
            if event.value in self.keys:
                first = self.keys[event.value]
                raise TextError(f"'{event.value}' is given twice (first in line {first})", line)
            self.keys[event.value] = line
        self.nodes += 1


def _check_events(events: object) -> None:
    sizes: dict[str, int] = {}
    """Values an anchor stands for."""
    open_: list[_Open] = []
    count = 0
    for event in events:  # type: ignore[attr-defined]
        line = event.start_mark.line + 1
        if open_ and isinstance(event, yaml.NodeEvent):
            open_[-1].take(event, line)
        if isinstance(event, yaml.AliasEvent):
            # an alias of a collection that is still open holds itself
            if any(each.anchor == event.anchor for each in open_):
                raise TextError(f"the alias {event.anchor!r} holds itself", line)
            count += sizes.get(event.anchor or "", 1)
        elif isinstance(event, yaml.ScalarEvent):
            count += 1
            _check_scalar(event.value, line)
            if event.anchor:
                sizes[event.anchor] = 1
        elif isinstance(event, yaml.CollectionStartEvent):
            keys: dict[str, int] | None = {} if isinstance(event, yaml.MappingStartEvent) else None
            open_.append(_Open(event.anchor, count, keys))
            count += 1
            if len(open_) > MAX_DEPTH:
                raise TextError("nested too deeply", line)
        elif isinstance(event, yaml.CollectionEndEvent):
            closed = open_.pop()
            if closed.anchor:
                sizes[closed.anchor] = count - closed.before
        if count > MAX_VALUES:
            raise TextError(f"names more than {MAX_VALUES} values (aliases of aliases?)", line)


def _check_scalar(value: str, line: int) -> None:
    for character in value:
        if (character < " " and character not in "\t\n\r") or "\ud800" <= character <= "\udfff":
            raise TextError(f"{character!a} is no character of a text", line)
    if len(value) > 250 and _TOO_LONG.fullmatch(value):
        raise TextError(f"a number of {len(value)} digits is too long", line)
