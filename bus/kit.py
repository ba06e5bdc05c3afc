"""The conformance suite as a plug-in of pytest, for whoever owns a board.

    pytest --can socketcan:can0 --board axis:0x11

runs every check on that board beside the tests of one's own. Those may use the fixtures `conformance_bus` (an
open python-can bus) and `board` (a `Board`: name, family, device). `--can-motion` lets the board move; it is
stopped at the end, an interrupt included. A project may put a `conformance_bus` of its own in the place of
this one, such as an emulated wire. From a checkout: `pytest -p bus.kit`.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    import can

    from bus.conformance import Board, CheckResult

CHECKS = (
    "answers", "identifier", "length", "device type", "contents", "period", "jitter", "gap", "undocumented",
    "uptime", "overruns", "error counter", "state", "sequence",
    "command", "health", "wrong length", "wrong device type", "unknown opcode", "out of range",
    "unknown identifier", "extended frame", "remote frame", "wrong state", "limits", "response time",
    "flooding", "still there",
)  # fmt: skip
CANOPEN = (
    "pre-operational", "boot-up", "state", "heartbeat", "object", "abort", "short request", "server",
    "operational", "stopped", "SYNC", "event again",
)  # fmt: skip
"""One test each, so that a report says what is wrong; with `--can-canopen` the second list."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """`--can`, `--board` and how boldly and patiently to check."""
    group = parser.getgroup("schmidt", "boards of the telescope")
    group.addoption(
        "--can", metavar="INTERFACE:CHANNEL", help="bus the boards are on, such as socketcan:can0"
    )
    group.addoption(
        "--board", action="append", default=[], metavar="TYPE:ID", help="board to check, such as axis:0x11"
    )
    group.addoption("--can-motion", action="store_true", help="also send commands that move something")
    group.addoption("--can-canopen", action="store_true", help="check what a CANopen master expects, instead")
    group.addoption("--can-stamps", type=float, default=0.001, help="uncertainty of time stamps, seconds")
    group.addoption("--can-speed", type=float, default=1.0, help="simulated seconds per second")


def _boards(config: pytest.Config) -> list[Board]:
    from bus.conformance import BoardError, parse

    try:
        return [parse(text) for text in config.getoption("--board")]
    except BoardError as error:
        raise pytest.UsageError(str(error)) from None


def _open(config: pytest.Config) -> can.BusABC:
    from bus.outside.external import SpecError, open_bus

    try:
        return open_bus(config.getoption("--can"))
    except SpecError as error:
        raise pytest.UsageError(str(error)) from None


@pytest.fixture(scope="session")
def conformance_bus(request: pytest.FixtureRequest) -> Iterator[can.BusABC]:
    """The bus that `--can` names; tests that want it are skipped without."""
    if not request.config.getoption("--can"):
        pytest.skip("no bus: --can INTERFACE:CHANNEL")
    with _open(request.config) as bus:
        yield bus


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test that wants a `board` runs once for each `--board`."""
    if "board" in metafunc.fixturenames:
        boards = _boards(metafunc.config)
        metafunc.parametrize("board", boards, ids=[board.name for board in boards], scope="session")


class _Found:
    """Results of the suite on all boards; it is run once, when the first of its tests is."""

    def __init__(self, config: pytest.Config, boards: Sequence[Board]) -> None:
        self.boards = boards
        self._config = config
        self._results: dict[str, list[CheckResult]] = {}

    def of(self, board: Board) -> list[CheckResult]:
        """What was found of `board`."""
        from bus.conformance import Settings, run

        if board.name not in self._results:
            option = self._config.getoption
            settings = Settings(
                motion=option("--can-motion"),
                stamps_s=option("--can-stamps"),
                speed=option("--can-speed"),
                canopen=option("--can-canopen"),
            )
            with _open(self._config) as bus:
                self._results[board.name] = run(bus, devices=[board], settings=settings)
        return self._results[board.name]


class ConformanceItem(pytest.Item):
    """One kind of check on one board."""

    def __init__(self, *, found: _Found, board: Board, check: str, **options: Any) -> None:
        super().__init__(**options)
        self.found, self.board, self.check = found, board, check

    def runtest(self) -> None:
        """Fail on errors and warn of issues, as the command does; skip what does not apply to this board."""
        results = [result for result in self.found.of(self.board) if result.check == self.check]
        if not results:
            pytest.skip("does not apply")
        wrong = [result for result in results if not result.passed]
        lines = [f"{r.level}: {r.subject}: expected {r.expected}, observed {r.observed}" for r in wrong]
        if any(result.level == "error" for result in wrong):
            pytest.fail("\n".join(lines), pytrace=False)
        for line in lines:
            warnings.warn(line, pytest.PytestWarning, stacklevel=1)

    def reportinfo(self) -> tuple[str, None, str]:
        """Where it says it comes from."""
        return "conformance", None, self.name


def pytest_collection_modifyitems(
    session: pytest.Session, config: pytest.Config, items: list[pytest.Item]
) -> None:
    """The suite, when a bus and a board are named."""
    boards = _boards(config)
    if not boards or not config.getoption("--can"):
        return
    found = _Found(config, boards)
    for board in boards:
        for check in CANOPEN if config.getoption("--can-canopen") else CHECKS:
            name = f"conformance[{board.name}-{check}]"
            items.append(
                ConformanceItem.from_parent(session, name=name, found=found, board=board, check=check)
            )
