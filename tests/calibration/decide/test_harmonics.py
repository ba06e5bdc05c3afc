"""A stage's harmonics that were one candidate, each with its own size."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.decide.parameters import findings_of
from calibration.decide.select import select
from tests.calibration.decide.made import line, problem

ROWS, ORDER = 4000, 3.0


@pytest.mark.parametrize("first", [0.0, 0.013])
@pytest.mark.parametrize("files", [1, 2])
def test_every_harmonic_has_its_own_amplitude_wherever_the_first_row_stands(first: float, files: int) -> None:
    """At position zero every sine of the first row is exactly zero."""
    turns = first + 1.5 * (1 - np.cos(2 * np.pi * np.arange(ROWS) / 1000.0))
    noise = np.random.default_rng(4).standard_normal(ROWS)
    sizes = {1: 0.5, 2: 2.0, 3: 0.3}
    waves = [size * np.cos(2 * np.pi * h * ORDER * turns + 0.4) for h, size in sizes.items()]
    p = problem(np.sum(waves, axis=0) + 0.3 * noise)
    label = np.arange(ROWS) * files // ROWS
    p.session = label
    own = [line("gear_eccentricity", turns, h * ORDER).columns for h in (1, 2, 3)]
    columns = np.hstack([c * (label == k)[:, None] for c in own for k in range(files)])
    whole = replace(line("gear_eccentricity", turns, ORDER), columns=columns, stage="screw", searched=1)
    s = select(p, [replace(whole, per_run=files > 1)], np.random.default_rng(1))
    found = findings_of(s, 0)
    assert sorted(f.harmonic or 0 for f in found) == [1, 2, 3]
    assert found[0].harmonic == 2
    assert found[0].order == pytest.approx(2 * ORDER)
    for f in found:
        assert f.parameters["amplitude"].value == pytest.approx(sizes[f.harmonic or 0], abs=0.05)


@pytest.mark.parametrize(("size", "noise", "seed"), [(2.0, 0.1, 4), (0.15, 0.3, 9)])
def test_neither_a_trifle_nor_what_is_within_its_error_is_listed(
    size: float, noise: float, seed: int
) -> None:
    """The second harmonic alone is there. In loud noise the others' share is no trifle beside it."""
    turns = 1.5 * (1 - np.cos(2 * np.pi * np.arange(ROWS) / 1000.0))
    loud = noise * np.random.default_rng(seed).standard_normal(ROWS)
    p = problem(size * np.cos(2 * np.pi * 2 * ORDER * turns + 0.4) + loud)
    columns = np.hstack([line("gear_eccentricity", turns, h * ORDER).columns for h in (1, 2, 3)])
    whole = replace(line("gear_eccentricity", turns, ORDER), columns=columns, stage="screw", searched=1)
    s = select(p, [whole], np.random.default_rng(1))
    assert [f.harmonic for f in findings_of(s, 0)] == [2]


@pytest.mark.parametrize("there", [True, False])
def test_a_harmonic_is_listed_only_where_held_out_rows_have_it(there: bool) -> None:
    """The second is on the fitted rows alone, as chance has it among many, or on all."""
    turns = 1.5 * (1 - np.cos(2 * np.pi * np.arange(ROWS) / 1000.0))
    p = problem(np.cos(2 * np.pi * ORDER * turns) + 0.1 * np.random.default_rng(2).standard_normal(ROWS))
    second = 0.2 * np.cos(2 * np.pi * 2 * ORDER * turns)
    p.y = p.y + np.where(p.held & (not there), -second, second)
    columns = np.hstack([line("gear_eccentricity", turns, h * ORDER).columns for h in (1, 2)])
    whole = replace(line("gear_eccentricity", turns, ORDER), columns=columns, stage="screw", searched=1)
    s = select(p, [whole], np.random.default_rng(1))
    assert [f.harmonic for f in findings_of(s, 0)] == ([1, 2] if there else [1])
