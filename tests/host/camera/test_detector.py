"""The detector: charge that a full well cannot hold, and the response of its pixels."""

import numpy as np
import pytest

from bus.time import generator
from host.camera.light import light
from host.camera.models import CAMERAS, GUIDE, MAIN, CameraModel, Window
from host.camera.readout import PIXEL_RESPONSE, bloom, flat, read_out
from host.camera.seeing import Wander
from host.camera.stars import stars
from host.sky.site import NAINITAL
from tests.host.camera.test_frames import CLOCK, frame, path

FULL_E = 100.0


def spilled(column: list[float]) -> list[float]:
    """The law by itself: again and again, every well that overflows gives half of it to either neighbour."""
    wells = [0.0, *column, 0.0]  # beyond the ends charge is gone
    for _ in range(100_000):
        over = [max(well - FULL_E, 0.0) for well in wells[1:-1]]
        if max(over) < 1e-9:
            break
        for k, each in enumerate(over, 1):
            wells[k] -= each
            wells[k - 1] += each / 2
            wells[k + 1] += each / 2
    return wells[1:-1]


def test_charge_is_neither_made_nor_lost_but_at_the_ends() -> None:
    random = generator(1, "charge")
    charge = random.exponential(60.0, (80, 50)) * np.where(random.uniform(size=(80, 50)) < 0.05, 40.0, 1.0)
    after, lost = bloom(charge, FULL_E)
    assert lost > 0 and charge.max() > 10 * FULL_E
    assert after.sum() + lost == pytest.approx(charge.sum(), rel=1e-12)
    assert after.max() <= FULL_E and np.all(after >= np.minimum(charge, FULL_E) - 1e-9)


def test_one_full_well_leaves_a_trail_as_long_as_its_charge() -> None:
    charge = np.zeros((41, 3))
    charge[20, 1] = 7.4 * FULL_E
    after, lost = bloom(charge, FULL_E)
    assert lost == 0 and not after[:, [0, 2]].any()
    column = after[:, 1] / FULL_E
    assert column[17:24] == pytest.approx(1.0) and column[[16, 24]] == pytest.approx(0.2)
    assert np.count_nonzero(column) == 9


@pytest.mark.parametrize("column", [
    [0, 0, 0, 0, 550, 0, 0, 0, 0], [20, 90, 40, 10, 430, 10, 40, 90, 20], [0, 0, 0, 300, 500, 300, 0, 0, 0],
])  # fmt: skip
def test_the_trail_of_one_star_is_that_of_wells_that_spill_by_turns(column: list[float]) -> None:
    after, _ = bloom(np.array(column, dtype=float)[:, None], FULL_E)
    assert after[:, 0] == pytest.approx(spilled(column), abs=1e-6)


def test_charge_leaves_the_chip_at_the_end_that_is_near() -> None:
    charge = np.zeros((30, 1))
    charge[2] = 21 * FULL_E
    after, lost = bloom(charge, FULL_E)
    assert lost == pytest.approx((10 - 2) * FULL_E)  # ten go up, where there is room for two
    assert np.count_nonzero(after[:, 0] == FULL_E) == 13


def test_a_frame_below_the_full_well_is_left_alone() -> None:
    charge = np.full((4, 4), FULL_E)
    after, lost = bloom(charge, FULL_E)
    assert lost == 0 and np.array_equal(after, charge)


def test_only_the_detector_without_a_drain_blooms() -> None:
    for model, blooms in ((MAIN, True), (GUIDE, False)):
        electrons = np.zeros((31, 5))
        electrons[15, 2] = 9 * model.full_well_e
        counts = read_out(model, electrons, 1, generator(1, "test")).astype(float) - model.offset_adu
        bright = counts > 0.5 * min(model.full_well_e / model.gain_e_adu, model.most_adu - model.offset_adu)
        assert np.count_nonzero(bright[:, 2]) == (9 if blooms else 1) and not bright[:, [0, 1, 3, 4]].any()


def test_a_bright_star_blooms_up_and_down_and_not_across() -> None:
    one = frame(20.0, model=MAIN, size=201)
    bright = one.counts > 0.9 * MAIN.full_well_e / MAIN.gain_e_adu
    rows, columns = bright.any(axis=1).sum(), bright.any(axis=0).sum()
    assert rows > 4 * columns > 0
    assert bright[100].any()


@pytest.mark.parametrize("model", CAMERAS)
def test_pixels_differ_by_a_per_cent_about_one(model: CameraModel) -> None:
    left, top, size = model.width // 2 - 150, model.height // 2 - 150, 300
    response = flat(model, Window(left=left, top=top, width=size, height=size))
    assert response.mean() == pytest.approx(1.0, abs=4 * PIXEL_RESPONSE / size)
    assert response.std() == pytest.approx(PIXEL_RESPONSE, rel=0.02)
    neighbours = np.corrcoef(response[:, 1:].ravel(), response[:, :-1].ravel())[0, 1]
    assert abs(neighbours) < 0.02
    part = flat(model, Window(left=left + 20, top=top + 30, width=40, height=50))
    assert np.array_equal(part, response[30:80, 20:60])


def test_a_corner_sees_the_aperture_and_the_sky_aslant() -> None:
    """An even sky falls off by the fourth power of the cosine, by hand: 25.66 mm from the axis at 500 mm."""
    far, wander = stars([0.0], [-1.5], [5.0]), Wander(MAIN.aperture_m, 1, MAIN.name)
    size, levels = 64, []
    for left, top in ((0, 0), ((MAIN.width - size) // 2, (MAIN.height - size) // 2)):
        window = Window(left=left, top=top, width=size, height=size)
        sky = light(MAIN, path(0.1), window, far, NAINITAL, CLOCK, wander)
        levels.append(float(sky.mean() * flat(MAIN, window).mean()))
    cosine = np.cos(np.arctan((2048 - size / 2) * np.sqrt(2) * 0.009 / 500))
    assert levels[0] / levels[1] == pytest.approx(cosine**4, abs=4 * PIXEL_RESPONSE / size)
