"""Buttons of the main console: what each asks of which board, and for how long it lasts."""

from collections.abc import Callable, Generator
from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import AxisParameter, Device, Health, MotionFlag, Opcode, SpeedClass
from host.client import ClientError
from host.procedures import dome, manual

RA, DEC = Device.AXIS_RA, Device.AXIS_DEC


class Console:
    """Notes what is asked and waited for; replies by `answer`. Every step takes a second."""

    def __init__(self, answer: Callable[..., int] = lambda *_: 0) -> None:
        self.asked: list[tuple[Any, ...]] = []
        self.said: list[str] = []
        self.devices = (RA, DEC)
        self.logs = Some(status=lambda _t, _who, text: self.said.append(text))
        self.seconds = 0
        self._answer = answer
        self.conditions: list[tuple[str, Callable[[], bool], float]] = []

    @property
    def now_ns(self) -> int:
        return self.seconds * 1_000_000_000

    def ask(self, *words: Any) -> Generator[None, None, Any]:
        self.asked.append(words)
        yield
        return Some(value=self._answer(*words))

    def wait(self, seconds: float) -> Generator[None, None, None]:
        self.asked.append(("wait", seconds))
        yield

    def until(self, what: str, there: Callable[[], bool], seconds: float) -> Generator[None, None, None]:
        self.conditions.append((what, there, seconds))
        yield


def done(procedure: Any, client: Console) -> list[tuple[Any, ...]]:
    for _ in procedure:
        client.seconds += 1
    return client.asked


def asked(make: Any, *arguments: Any) -> list[tuple[Any, ...]]:
    client: Any = Console()
    return done(make(client, *arguments), client)


@pytest.mark.parametrize(("direction", "sign"), [("+", 1), ("-", -1)])
def test_a_button_moves_while_it_is_held(direction: str, sign: int) -> None:
    assert asked(manual.hold_button, "dec", "guide", direction, 2.5) == [
        (DEC, Opcode.SET_CLASS, SpeedClass.GUIDE, sign), ("wait", 2.5), (DEC, Opcode.STOP)
    ]  # fmt: skip


def test_a_rate_and_an_effort_stay() -> None:
    """Counts of 0.01148 arcsec in 5 ms, times 65536; 3000 steps of effort."""
    counts = 15.0 * 0.005 / (1296000 / (4.608e6 * 24.5)) * 65536
    (rate, waited) = asked(manual.set_rate, "ra", 15.0, 3.0)
    assert rate[:2] == (RA, Opcode.SET_RATE) and rate[2] == pytest.approx(counts, abs=1)
    assert waited == ("wait", 3.0)
    assert asked(manual.open_loop, "ra", -0.25, 1.0) == [(RA, Opcode.OPEN_LOOP, -750), ("wait", 1.0)]


@pytest.mark.parametrize(("axis", "boards"), [("ra", [RA]), ("dec", [DEC]), ("both", [RA, DEC])])
def test_stop_stops_what_it_is_told_to(axis: str, boards: list[Device]) -> None:
    assert asked(manual.stop, axis) == [(board, Opcode.STOP) for board in boards]


def test_parameters_are_loaded_in_their_order_and_checked() -> None:
    client: Any = Console(lambda *words: words[3])
    rows = [(3, 7), (1, -5)]
    assert done(manual.load(client, RA, rows), client) == [
        (RA, Opcode.SET_PARAMETER, 3, 7), (RA, Opcode.SET_PARAMETER, 1, -5)
    ]  # fmt: skip
    assert client.said == ["AXIS_RA: 2 parameters loaded"]
    other: Any = Console(lambda *words: 6 if words[2] == 1 else words[3])
    with pytest.raises(ClientError, match="AXIS_RA: parameter 1 is 6, not -5"):
        done(manual.load(other, RA, rows), other)


def test_a_healthy_network_is_asked_once_and_one_that_recovers_again() -> None:
    client: Any = Console()
    assert done(manual.health_check(client), client) == [(RA, Opcode.PING), (DEC, Opcode.PING)]
    assert client.said == ["health check passed, 2 boards"]
    late: Any = Console(lambda device, _: 1 if device == DEC and late.seconds < 3 else 0)
    assert done(manual.health_check(late), late)[:3] == [
        (RA, Opcode.PING),
        (DEC, Opcode.PING),
        (DEC, Opcode.PING),
    ]
    assert set(late.asked[2:]) == {(DEC, Opcode.PING)} and late.said


def test_a_board_that_stays_ill_is_named_with_what_it_reports() -> None:
    flags = [flag for flag in Health if flag.name][:2]
    ill: Any = Console(lambda device, _: int(flags[0] | flags[1]) if device == RA else 0)
    with pytest.raises(ClientError) as caught:
        done(manual.health_check(ill), ill)
    words = ", ".join(str(flag.name).lower() for flag in flags)
    assert str(caught.value) == f"health check: AXIS_RA reports {words}"
    assert 5 < ill.seconds < 9  # five seconds of patience, and the round that was on


def test_power_comes_after_the_check_to_both_axes() -> None:
    client: Any = Console()
    done(manual.power_on(client), client)
    pings, rest = client.asked[:2], client.asked[2:]
    assert [words[1] for words in pings] == [Opcode.PING] * 2
    assert rest == [(RA, Opcode.POWER, 1), (DEC, Opcode.POWER, 1)]
    assert [(what, seconds) for what, _, seconds in client.conditions] == [
        ("AXIS_RA: powered", 2.0), ("AXIS_DEC: powered", 2.0)
    ]  # fmt: skip
    assert asked(manual.power_on, False, 512) == [
        (DEC, Opcode.SET_PARAMETER, AxisParameter.COUNTER_BIAS_Q8, 512), (RA, Opcode.POWER, 1),
        (DEC, Opcode.POWER, 1),
    ]  # fmt: skip
    assert asked(manual.power_off) == [(RA, Opcode.POWER, 0), (DEC, Opcode.POWER, 0)]


@pytest.mark.parametrize(
    ("flags", "on"),
    [(None, False), (MotionFlag(0), False), (MotionFlag.POWERED, True), (MotionFlag.MOVING, False)],
)
def test_an_axis_is_on_when_it_says_so(flags: MotionFlag | None, on: bool) -> None:
    client: Any = Some(motion=lambda _: None if flags is None else Some(flags=flags))
    assert manual.powered(client, RA) is on


def test_the_slit_is_there_when_it_rests_within_a_degree(monkeypatch: pytest.MonkeyPatch) -> None:
    client: Any = Console()
    done(dome.turn(client, 359.6), client)
    ((_, _, argument),) = client.asked
    assert argument == 35960
    ((what, there, seconds),) = client.conditions
    assert what == "DOME: at azimuth 359.6°" and seconds == 300.0
    for now, good in (
        (None, False), ({"Moving": 0, "Azimuth": 359.0}, True), ({"Moving": 1, "Azimuth": 359.6}, False),
        ({"Moving": 0, "Azimuth": 0.5}, True), ({"Moving": 0, "Azimuth": 0.7}, False),
        ({"Moving": 0, "Azimuth": 358.5}, False),
    ):  # fmt: skip
        monkeypatch.setattr(dome, "reading", lambda *_, now=now: now)
        assert there() is good, now


@pytest.mark.parametrize(("opened", "word"), [(True, "Opened"), (False, "Closed")])
def test_the_shutter_is_there_when_it_has_met_its_end(
    opened: bool, word: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    client: Any = Console()
    done(dome.shutter(client, opened), client)
    assert client.asked[0][2] == int(opened)
    ((what, there, seconds),) = client.conditions
    assert what == f"DOME: {word.lower()}" and seconds == 300.0
    for now in (None, {"Opened": 0, "Closed": 0}, {"Opened": 1, "Closed": 0}, {"Opened": 0, "Closed": 1}):
        monkeypatch.setattr(dome, "reading", lambda *_, now=now: now)
        assert there() is bool(now and now[word])


def test_azimuths_are_hundredths_of_a_turn_s_degrees() -> None:
    assert [dome.centidegrees(x) for x in (0.0, 359.99, 360.0, -0.25, 12.345)] == [0, 35999, 0, 35975, 1234]
