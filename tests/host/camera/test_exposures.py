"""A camera's states, from the order of an exposure to its frame; looks come from the test."""

import threading
from collections.abc import Callable

import numpy as np
import pytest

from bus.time import generator
from host.camera.camera import Camera, Frame, Order, State, expose
from host.camera.models import GUIDE, Look, Window
from host.camera.readout import read_out
from host.camera.stars import stars
from host.sky.site import NAINITAL
from tests.host.camera.still import Still
from tests.host.camera.test_frames import CLOCK

WINDOW = Window(left=600, top=400, width=4, height=4)
DARK = stars([0.0], [-1.5], [5.0])


def camera(keep: Callable[[Frame], object] | None = None) -> Camera:
    return Camera(GUIDE, DARK, NAINITAL, CLOCK, 7, keep)


def at(t_s: float, hour_angle: float = 0.25) -> Look:
    return Look(round(t_s * 1e9), hour_angle, 0.5, 0.0, 0.0)


def settled(made: Camera) -> Camera:
    """Its frame's thread is over."""
    for each in threading.enumerate():
        if each.name == "frame":
            each.join(10.0)
    return made


def test_an_exposure_goes_from_the_order_to_the_frame() -> None:
    made = camera()
    assert (made.state, made.done, made.looking, made.frame) == (State.IDLE, 0.0, False, None)
    made.take(at(0.0))  # nobody asked
    made.start(Order(seconds=0.5, window=WINDOW))
    assert (made.state, made.done, made.looking) == (State.EXPOSING, 0.0, True)
    made.take(at(1.0))
    assert made.done == 0.0
    made.take(at(1.2))
    assert made.done == pytest.approx(0.4)
    made.take(at(1.6, 0.29))
    assert not made.looking
    frame = settled(made).frame
    assert frame is not None and (made.state, made.done, made.error) == (State.IDLE, 1.0, "")
    assert (frame.start_s, frame.seconds) == pytest.approx((1.0, 0.5))
    assert len(frame.looks) == 3 and frame.counts.shape == (4, 4)
    assert frame.looks[-1] == pytest.approx((1_500_000_000, 0.25 + 0.04 * 0.75, 0.5, 0.0, 0.0))


def test_a_look_just_at_the_end_is_taken_as_it_is() -> None:
    made = camera()
    made.start(Order(seconds=0.5, window=WINDOW))
    for t_s in (1.0, 1.5):
        made.take(at(t_s))
    frame = settled(made).frame
    assert frame is not None and frame.looks == (at(1.0), at(1.5))


def test_an_exposure_of_no_time_still_has_two_looks() -> None:
    made = camera()
    made.start(Order(seconds=0.0, window=WINDOW))
    made.take(at(1.0))
    assert made.looking
    made.take(at(1.25))
    frame = settled(made).frame
    assert frame is not None and frame.seconds == 0.0


def test_a_stop_reads_out_what_there_is_and_an_abort_keeps_nothing() -> None:
    made = camera()
    made.stop()  # nothing is open
    made.start(Order(seconds=5.0, window=WINDOW))
    for t_s in (1.0, 1.1):
        made.take(at(t_s))
    assert made.looking
    made.stop()
    made.take(at(1.25))
    frame = settled(made).frame
    assert frame is not None and frame.seconds == pytest.approx(0.25)
    made.start(Order(seconds=5.0, window=WINDOW))
    assert made.frame is None
    made.take(at(2.0))
    made.abort()
    assert (made.state, made.looking, made.done) == (State.IDLE, False, 0.0)
    made.start(Order(seconds=1.0, window=WINDOW))  # the stop of before is forgotten
    for t_s in (3.0, 3.5):
        made.take(at(t_s))
    assert made.looking and made.done == pytest.approx(0.5)


def test_what_keeping_a_frame_raises_is_an_error_until_the_next_order() -> None:
    def full(_: Frame) -> None:
        raise OSError("no space left")

    made = camera(full)
    made.start(Order(seconds=0.1, window=WINDOW))
    for t_s in (1.0, 1.1):
        made.take(at(t_s))
    settled(made)
    assert (made.state, made.error, made.frame) == (State.ERROR, "OSError: no space left", None)
    made.start(Order(seconds=0.1, window=WINDOW))
    assert (made.state, made.error) == (State.EXPOSING, "")


def test_a_frame_that_was_aborted_while_it_is_made_does_not_come() -> None:
    go, kept = threading.Event(), list[Frame]()

    def slow(frame: Frame) -> None:
        kept.append(frame)
        assert go.wait(10.0)

    made = camera(slow)
    made.start(Order(seconds=0.1, window=WINDOW))
    for t_s in (1.0, 1.1):
        made.take(at(t_s))
    assert made.state.name == "READING"
    made.abort()
    go.set()
    settled(made)
    assert len(kept) == 1 and made.frame is None and made.state == State.IDLE


def test_an_aborted_frame_does_not_come_in_the_place_of_the_next() -> None:
    go = threading.Event()
    made = camera(lambda _: go.wait(10.0))
    made.start(Order(seconds=0.1, window=WINDOW))
    for t_s in (1.0, 1.1):
        made.take(at(t_s))
    made.abort()
    made.start(Order(seconds=0.1, window=WINDOW))
    go.set()
    settled(made)
    assert made.frame is None and made.state == State.EXPOSING


def test_every_exposure_has_noise_of_its_own_and_the_seeds() -> None:
    def two() -> list[Frame]:
        kept: list[Frame] = []
        made = camera(kept.append)
        for _ in range(2):
            made.start(Order(seconds=0.1, window=WINDOW))
            for t_s in (1.0, 1.1):
                made.take(at(t_s))
            settled(made)
        return kept

    first, second = two(), two()
    assert np.array_equal(first[0].counts, second[0].counts)
    assert np.array_equal(first[1].counts, second[1].counts)
    assert not np.array_equal(first[0].counts, first[1].counts)


@pytest.mark.parametrize("lit", [False, True])
def test_a_dark_frame_has_the_dark_current_alone(lit: bool) -> None:
    """Half an electron a second at 0.4 electrons to a count: 1000 s are 1250 counts above 500 of offset.

    The sky of 21 mag adds a quarter of an electron a second, 658 counts.
    """
    order = Order(seconds=1000.0, window=Window(left=600, top=400, width=30, height=30), lit=lit)
    looks = (at(500.0), at(1500.0))
    frame = expose(GUIDE, order, looks, DARK, NAINITAL, CLOCK, Still(), generator(1, "test"))
    dark = 500 + 0.5 * 1000 / 0.4
    sky = 0.2634 * 1000 / 0.4 if lit else 0.0
    assert frame.counts.mean() == pytest.approx(dark + sky, abs=8.0)
    assert frame.counts.std() > 50


def test_bins_are_summed_before_they_are_read() -> None:
    """3 by 2 bins of a chip with a rest: noise of one readout, electrons of four pixels."""
    electrons = np.full((7, 5), 4000.0)
    bins = np.array([read_out(GUIDE, electrons, 2, generator(k, "bins")) for k in range(200)], dtype=float)
    assert bins.shape == (200, 3, 2)
    assert bins.mean() == pytest.approx(500 + 16000 / 0.4, rel=2e-3)
    assert bins.std() * 0.4 == pytest.approx(np.hypot(np.sqrt(16000), 4.0), rel=0.06)


def test_readout_noise_alone_and_the_converters_ends() -> None:
    nothing = read_out(GUIDE, np.zeros((100, 100)), 1, generator(1, "noise")).astype(float)
    assert nothing.mean() == pytest.approx(500, abs=0.5) and nothing.std() == pytest.approx(10.0, rel=0.03)
    full = read_out(GUIDE, np.full((20, 20), 1e6), 1, generator(1, "full"))
    assert full.mean() == pytest.approx(500 + 20000 / 0.4, abs=3)
    over = read_out(GUIDE, np.full((20, 20), 1e6), 2, generator(1, "full"))
    assert np.all(over == 65535)
