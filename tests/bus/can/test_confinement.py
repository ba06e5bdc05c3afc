"""Error counters at their limits (ISO 11898-1)."""

import pytest

from bus.can import Wire, confinement
from bus.can.port import Port
from bus.time import EventQueue


def port(tec: int = 0, rec: int = 0) -> Port:
    found = Wire(EventQueue()).attach("a")
    found.tec, found.rec = tec, rec
    return found


@pytest.mark.parametrize(
    ("tec", "rec", "state"), [(127, 127, "active"), (128, 0, "passive"), (0, 128, "passive")]
)
def test_passive_begins_at_128(tec: int, rec: int, state: str) -> None:
    assert port(tec, rec).state == state


@pytest.mark.parametrize(("tec", "off"), [(247, False), (248, True)])
def test_off_begins_at_256(tec: int, off: bool) -> None:
    assert confinement.send_failed(port(tec), acknowledge=False) == off


@pytest.mark.parametrize(
    ("tec", "acknowledge", "after"), [(0, True, 8), (127, True, 135), (128, True, 128), (128, False, 136)]
)
def test_a_missing_acknowledge_stops_counting_when_passive(tec: int, acknowledge: bool, after: int) -> None:
    node = port(tec)
    confinement.send_failed(node, acknowledge=acknowledge)
    assert node.tec == after


@pytest.mark.parametrize(("rec", "after"), [(0, 0), (1, 0), (127, 126), (128, 127), (255, 127)])
def test_a_good_reception(rec: int, after: int) -> None:
    node = port(0, rec)
    confinement.received([node])
    assert node.rec == after


@pytest.mark.parametrize(("tec", "after"), [(0, 0), (1, 0), (200, 199)])
def test_a_good_transmission(tec: int, after: int) -> None:
    node = port(tec)
    confinement.sent(node)
    assert node.tec == after


@pytest.mark.parametrize(
    ("rec", "first", "after"),
    [(0, False, 1), (0, True, 9), (127, True, 136), (128, True, 129), (255, False, 255), (250, False, 251)],
)
def test_a_bad_reception(rec: int, first: bool, after: int) -> None:
    node, silent = port(0, rec), port(0, 5)
    silent.listen_only = True
    confinement.receive_failed([node, silent], node if first else None)
    confinement.received([silent])
    assert (node.rec, silent.rec) == (after, 5)


@pytest.mark.parametrize(("rec", "after"), [(0, 8), (127, 135), (247, 255), (248, 255), (255, 255)])
def test_dominant_bits_behind_the_flag_count_eight(rec: int, after: int) -> None:
    node, silent = port(0, rec), port(0, rec)
    silent.listen_only = True
    confinement.still_dominant([node, silent])
    assert (node.rec, silent.rec) == (after, rec)


@pytest.mark.parametrize(
    ("rec", "silent", "full"), [(254, False, False), (255, False, True), (0, True, True)]
)
def test_a_counter_that_goes_no_higher(rec: int, silent: bool, full: bool) -> None:
    node = port(0, rec)
    node.listen_only = silent
    assert confinement.saturated(node) == full
