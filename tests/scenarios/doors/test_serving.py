"""`schmidt serve` over stand-ins: in which order things are made, opened, ended and told."""

from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console
from rich.text import Text

from bus.can import Frame
from scenarios.doors import serving
from scenarios.doors.host_door import HostProcess
from scenarios.doors.options import ServeOptions
from tests.scenarios.doors.served import stub, stub_served

PARTS = ("Recording", "LiveNetwork", "Steps", "Snapshots", "Feed", "make_doors", "Loop", "chosen", "standing",
         "read", "park", "first", "check", "wire")  # fmt: skip
"""What `serve` puts together."""


class Desk:
    """Everything that serving is made of. told: who did what, in order; said: lines for the user."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.told: list[Any] = []
        self.said: list[str] = []
        self.updates: list[str] = []
        self.broken: OSError | None = None
        self.served = stub_served()
        self.served.lines = stub(uarts={"AXIS_RA": 0, "FOCUS": 0})
        self.served.punctual.text = lambda: "ticks on time"
        self.console = stub(print=self.print, is_terminal=True)
        for part in PARTS:
            monkeypatch.setattr(serving, part, getattr(self, part.lower(), self.hear(part)))
        monkeypatch.setattr(serving, "Console", lambda: self.console)
        monkeypatch.setattr(serving, "Live", self.live)
        monkeypatch.setattr(serving, "Keeper", self.keeper)
        monkeypatch.setattr(serving, "interrupts", self.interrupts)
        monkeypatch.setattr(serving, "_warm_up", self.hear("warm"))

    def hear(self, who: str, answer: Any = None) -> Any:
        def call(*given: Any, **more: Any) -> Any:
            self.told.append(who)
            return answer

        return call

    def print(self, text: str, **how: Any) -> None:
        """On a narrow terminal. Colours are kept of lines that shall have none."""
        file = StringIO()
        Console(file=file, width=10, force_terminal=True, color_system="standard").print(text, **how)
        told = file.getvalue().removesuffix("\n")
        self.said.append(told if "highlight" in how else Text.from_ansi(told).plain)

    def chosen(self, *given: Any) -> tuple[str, str]:
        self.told.append(("chosen", *given))
        return "scenario", "model"

    def standing(self, found: Any) -> Any:
        return stub(scenario="stood", model="stood", found=found)

    def read(self, file: Path) -> str:
        return f"read {file}"

    def livenetwork(self, *given: Any) -> Any:
        self.made = given
        return self.served

    def recording(self, folder: Path, begun: Path | None) -> Any:
        self.told.append(("recorded", folder, begun))
        return stub(attach=self.hear("attached"), close=lambda end_ns: f"{end_ns:032d}")

    def steps(self, served: Any) -> str:
        return "steps"

    def feed(self, *given: Any) -> None:
        self.told.append(("fed", *given[1:]))

    def make_doors(self, *_: Any) -> list[Any]:
        self.told.append("doors")
        return [stub(name="--lx200 4030", state=lambda: "1 clients")]

    def keeper(self, door: Any, _say: Any) -> Any:
        return stub(open=self.open, close=self.hear("close"))

    def open(self) -> None:
        self.told.append("open")
        if self.broken is not None:
            raise self.broken

    def loop(self, *given: Any) -> Any:
        self.looped = given
        return stub(run=self.hear("run"), text=lambda: "it was long")

    def park(self, _served: Any, say: Any) -> str:
        self.told.append("park")
        return "parked, motors off"

    @contextmanager
    def first(self, asked: bool) -> Iterator[str]:
        self.told.append(f"first {asked}")
        yield "ticks first"

    @contextmanager
    def interrupts(self, stop: Any) -> Iterator[None]:
        assert stop == self.served.stop
        yield

    @contextmanager
    def live(self, *_: Any, **how: bool) -> Iterator[Any]:
        assert how.pop("console") is self.console and how == {"auto_refresh": False, "transient": True}

        def update(text: str, refresh: bool) -> None:
            assert refresh
            self.updates.append(text)

        yield stub(refresh=self.hear("refresh"), update=update)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


def test_time_starts_when_all_is_open_and_the_axes_are_parked_after_it(desk: Desk) -> None:
    options = ServeOptions(scenario=Path("s"), seed=3, plant="p", network="lab", speed=1.0, duration=2.0)
    assert serving.serve(options) == 0
    chosen = ("chosen", Path("s"), 3, "p", "lab")
    order = ["check", chosen, "refresh", "doors", "warm", "open", "first False", "run", "close", "park"]
    assert desk.told == order
    assert desk.made == ("scenario", "model", 1.0, None, None) and desk.looped[0] is desk.served
    assert desk.looped[4:] == (2.0, None) and desk.served.steps is None
    assert desk.said == [
        "serving 2 boards at 1 times real time; Ctrl-C ends it",
        "  --lx200 4030  LX200 over TCP, 127.0.0.1:4030",
        "ticks first", "it was long", "  --lx200 4030: 1 clients", "parked, motors off",
    ]  # fmt: skip


def test_a_door_that_cannot_open_ends_it_parked(desk: Desk) -> None:
    desk.broken = OSError("port taken")
    with pytest.raises(OSError, match="port taken"):
        serving.serve(ServeOptions(record=Path("f")))
    assert desk.told[-2:] == ["close", "park"] and "run" not in desk.told and desk.said == []


def test_a_session_is_recorded_from_its_doors_on(desk: Desk) -> None:
    desk.served.now_ns = 12
    serving.serve(ServeOptions(record=Path("f[b]"), begun=Path("b"), snapshots=Path("d")))
    told = [each for each in desk.told if each in ("doors", "attached", "warm", "Snapshots")]
    assert told == ["Snapshots", "doors", "attached", "warm"]
    assert ("recorded", Path("f[b]"), Path("b")) in desk.told
    assert desk.made[:2] == ("stood", "stood") and desk.made[4].found == "read b"
    assert not any(each[0] == "chosen" for each in desk.told)
    assert desk.said[-1] == f"recorded in f[b], digest {'0' * 16}; schmidt replay f[b] repeats it"


@pytest.mark.parametrize("more", [{}, {"record": Path("f")}, {"snapshots": Path("f")}])
def test_frames_of_a_muted_board_are_not_recorded(more: dict[str, Any], desk: Desk) -> None:
    options = ServeOptions(muted=("DISPLAY", Path("log")), **more)
    if more:
        with pytest.raises(ValueError, match=r"--mute with --record or --snapshots: .* leave one out"):
            serving.serve(options)
        assert "doors" not in desk.told
    else:
        assert serving.serve(options) == 0 and ("fed", "DISPLAY", Path("log")) in desk.told


def test_where_clients_step_nothing_is_parked(desk: Desk) -> None:
    assert serving.serve(ServeOptions(clock="steps")) == 0
    assert desk.served.steps == "steps" and "park" not in desk.told
    assert desk.said[-1] == "left where they stood"
    assert desk.said[0] == "serving 2 boards as clients step them; Ctrl-C ends it"


def test_a_speed_has_bounds(desk: Desk) -> None:
    with pytest.raises(ValueError, match="speed"):
        serving.serve(ServeOptions(speed=2000.0))
    assert not desk.told


@pytest.mark.parametrize("terminal", [False, True])
def test_a_terminal_has_a_line_that_is_written_over(terminal: bool, desk: Desk) -> None:
    desk.console.is_terminal = terminal
    serving.serve(ServeOptions())
    desk.looped[3]("how it stands")
    assert desk.updates == (["how it stands"] if terminal else [])


@pytest.mark.parametrize(("options", "said"), [
    ({}, "first False"), ({"speed": 1.1}, None), ({"clock": "steps"}, None), ({"realtime": False}, None),
    ({"realtime": True}, "first True"), ({"realtime": True, "speed": 9.0}, "first True"),
    ({"speed": 0.5}, "first False"),
])  # fmt: skip
def test_ticks_come_first_where_that_is_meant(options: dict[str, Any], said: str | None, desk: Desk) -> None:
    with serving._ahead(ServeOptions(**options)) as line:
        assert line == (None if said is None else "ticks first")
    assert desk.told == ([] if said is None else [said])


def test_nothing_is_said_of_a_class_that_was_not_meant(desk: Desk) -> None:
    serving.serve(ServeOptions(realtime=False))
    assert desk.said[2] == "it was long"
    assert isinstance(serving._ahead(ServeOptions(realtime=False)), nullcontext)


def test_another_network_is_run_for_a_moment(monkeypatch: pytest.MonkeyPatch) -> None:
    """So that all is compiled: twenty milliseconds, four ticks of the boards."""
    ran: list[int] = []
    taps: list[Any] = []
    file = BytesIO()

    def run_until(t_ns: int) -> None:
        ran.append(t_ns)
        taps[0](t_ns, Frame(0x11, b"\x11"))

    network = stub(wire=stub(tap=taps.append), run_until=run_until)
    monkeypatch.setattr(serving, "wire", lambda scenario, model: network)
    monkeypatch.setattr(serving, "BytesIO", lambda: file)
    nothing: Any = None
    serving._warm_up(nothing, nothing)
    assert ran == [20_000_000] and file.getvalue().endswith(b"011#11\n")


def test_doors_of_the_host_are_told_with_their_names_in_a_column(desk: Desk) -> None:
    """The host itself is no option. A token that a name ends with is not told again."""
    host: Any = HostProcess.__new__(HostProcess)
    host.doors = [("the host", "ready"), ("--console 8080 (open it with ?token=x)", "2 [b]pages shown"),
                  ("--alpaca 11111[b]", "")]  # fmt: skip
    doors = [stub(name="--lx200 4030", state=lambda: ""), host]
    serving._say_hello(desk.console, desk.served, doors)
    width = len("--console 8080 (open it with ?token=x)")
    names = [line[2 : 2 + width].rstrip() for line in desk.said[1:]]
    assert names == ["--lx200 4030", "--console 8080 (open it with ?token=x)", "--alpaca 11111[b]"]
    assert all(line[2 + width : 4 + width] == "  " for line in desk.said[1:])
    desk.said.clear()
    desk.served.punctual.ticks = 3
    loop: Any = stub(text=lambda: "it was long")
    serving._say_goodbye(desk.console, loop, desk.served, doors)
    assert desk.said == [
        "it was long", "  the host: ready", "  --console 8080: 2 [b]pages shown",
        "  nobody came to --lx200 4030, --alpaca 11111[b]", "ticks on time",
    ]  # fmt: skip
