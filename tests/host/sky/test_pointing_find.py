"""Sealed pointing runs: undeclared terms are named, sound mounts are left alone. The mount is the plant's."""

from collections.abc import Callable

import numpy as np
import pytest

from bus.units import ARCSEC
from host.sky.pointfind import Answer, find
from host.sky.pointmodel import GEOMETRY, TERMS, Array
from host.sky.pointstars import Stars, rms
from plant.mount import sky
from tests.host.sky.seen import LATITUDE, axes, errors

NOISE_ARCSEC = 1.0
"""Of each coordinate: half a second of seeing and centring, doubled. ASSUMPTION."""
RATIO = 2.0
"""Rms of what the declared terms leave of the effect over that of the noise."""
STARS = 40
GEOMETRIC = ("hour_angle_index", "declination_index", "polar_azimuth", "polar_altitude", "collimation",
             "non_perpendicularity")  # fmt: skip
PLANT_SIDE = {"TF": "tube_flexure", "FO": "fork_flexure", "DAF": "axis_flexure", "TX": "refraction"}
ENCODERS: dict[str, Callable[[Array, Array], tuple[Array, Array]]] = {
    "HCES": lambda ra, dec: (np.sin(ra), 0 * dec),
    "HCEC": lambda ra, dec: (np.cos(ra), 0 * dec),
    "DCES": lambda ra, dec: (0 * ra, np.sin(dec)),
    "DCEC": lambda ra, dec: (0 * ra, np.cos(dec)),
}
"""What an encoder off its centre reads too much, of its own angle."""
OUTSIDE: dict[str, Callable[[Array, Array, Array], tuple[Array, Array]]] = {
    "hour angle": lambda ra, dec, _: (0 * ra, np.sign(ra) * np.ones_like(dec)),  # a mirror that flops
    "declination": lambda ra, dec, _: (np.cos(3 * dec + 0.7), 0 * dec),  # an encoder's third harmonic
    "temperature": lambda ra, _, temperature: (0 * ra, temperature**2 / 20),  # a tube that shrinks
}
"""What no term describes, east-west on the sky and north-south, over a variable."""


def run(
    seed: int, term: str | None = None, over: str | None = None, ratio: float = RATIO, count: int = STARS
) -> Stars:
    """A run of a mount with drawn geometry and one thing more."""
    random = np.random.default_rng(seed)
    geometry = {name: float(random.uniform(-200, 200)) for name in GEOMETRIC}
    ra, dec = axes(count, seed)
    temperature = np.linspace(8, -6, count) + random.normal(0, 0.5, count)
    noise = random.normal(0, NOISE_ARCSEC, (2, len(ra)))
    sign = float(random.choice([-1, 1]))

    def seen(size: float, noise: Array, **geometry: float) -> Stars:
        inside = {PLANT_SIDE[term]: size} if term in PLANT_SIDE else {}
        h, d = sky(ra, dec, LATITUDE, errors(**geometry, **inside))
        x, y = ENCODERS[term](ra, dec) if term in ENCODERS else (0 * ra, 0 * dec)
        west, north = OUTSIDE[over](ra, dec, temperature) if over is not None else (0 * ra, 0 * dec)
        return Stars(
            h=h + (size * west + noise[0]) * ARCSEC / np.cos(d), d=d + (size * north + noise[1]) * ARCSEC,
            ra=ra + size * ARCSEC * x, dec=dec + size * ARCSEC * y,
            latitude_rad=LATITUDE, others={"temperature": temperature},
        )  # fmt: skip

    left = rms(seen(1.0, 0 * noise).left(GEOMETRY))
    return seen(sign * ratio * np.sqrt(2) * NOISE_ARCSEC / left if left else 0.0, noise, **geometry)


def names(answer: Answer) -> list[set[str]]:
    """Of each thing that is missing: its name and what explains as well, or its variable."""
    return [{lack.name, *lack.equivalent} if lack.over is None else {lack.over} for lack in answer.lacks]


@pytest.mark.parametrize("term", [*PLANT_SIDE, *ENCODERS])
def test_a_term_that_is_missing_is_named_with_its_size(term: str) -> None:
    answer = find(run(7000, term))
    assert [term in each for each in names(answer)] == [True]
    assert answer.after_arcsec < 0.7 * answer.before_arcsec


@pytest.mark.parametrize("over", OUTSIDE)
def test_what_is_no_term_is_unknown_over_its_variable(over: str) -> None:
    answer = find(run(7001, over=over))
    assert answer.verdict == "unknown"
    assert names(answer) in ([{over}], [{"order of the run"}])  # the night cools as it goes on
    assert answer.after_arcsec < 0.8 * answer.before_arcsec


def test_what_would_not_have_been_seen_is_said() -> None:
    answer = find(run(7002, ratio=0.0))
    assert answer.verdict == "nothing" and not answer.lacks
    assert {*answer.unseen_arcsec, *answer.confounded, *GEOMETRY} == {*TERMS}
    seen = find(run(7002, "HCES", ratio=3 * answer.unseen_arcsec["HCES"] / NOISE_ARCSEC))
    assert "HCES" in names(seen)[0]


@pytest.mark.slow
def test_sealed_runs_hold_their_rates() -> None:
    """Of 30 sound mounts none gets a name; of 64 with one term more at twice the noise 95 % are right."""
    assert [names(find(run(seed, ratio=0.0))) for seed in range(8000, 8030)] == [[]] * 30
    right = [
        [term in each for each in names(find(run(seed, term)))] == [True]
        for term in [*PLANT_SIDE, *ENCODERS]
        for seed in range(8100, 8108)
    ]
    assert len(right) == 64
    assert np.mean(right) >= 0.95
