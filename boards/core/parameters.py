"""The parameter table of a board: numbers, bounds, and what to do when one changes."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from boards.core.results import OUT_OF_RANGE, Answer
from bus.protocol import Result


@dataclass(frozen=True, slots=True)
class Parameter:
    """One row: number on the wire, name, bounds (inclusive, integers in the unit the name says),
    accessors."""

    number: int
    name: str
    low: int
    high: int
    read: Callable[[], int]
    write: Callable[[int], None]


def _nothing() -> None:
    """Nothing follows from a change."""


def kept(
    number: int,
    name: str,
    bounds: tuple[int, int],
    owner: object,
    attribute: str,
    changed: Callable[[], None] = _nothing,
) -> Parameter:
    """A parameter whose value is an attribute of `owner`; `changed` is called after it is set."""

    def write(value: int) -> None:
        setattr(owner, attribute, value)
        changed()

    return Parameter(number, name, *bounds, lambda: int(getattr(owner, attribute)), write)


class ParameterTable:
    """Answers GET_PARAMETER and SET_PARAMETER."""

    def __init__(self, rows: Iterable[Parameter] = ()) -> None:
        self._rows = {row.number: row for row in rows}

    def rows(self) -> tuple[Parameter, ...]:
        """All of them, by number."""
        return tuple(self._rows[number] for number in sorted(self._rows))

    def get(self, number: int) -> Answer:
        """The value, or out of range when there is no such parameter."""
        row = self._rows.get(number)
        return (
            OUT_OF_RANGE._replace(parameter=number) if row is None else Answer(Result.OK, number, row.read())
        )

    def set(self, number: int, value: int) -> Answer:
        """Change it when it exists and the value is inside its bounds; the reply carries the value in
        force."""
        row = self._rows.get(number)
        if row is None:
            return Answer(Result.OUT_OF_RANGE, number, value)
        if not row.low <= value <= row.high:
            return Answer(Result.OUT_OF_RANGE, number, row.read())
        row.write(value)
        return Answer(Result.OK, number, row.read())
