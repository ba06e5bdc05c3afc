"""Inertia that couples other joints of an arm to this one: no effect of the catalogue, and a real force."""

import numpy as np

from calibration.finding import UNKNOWN
from calibration.inputs.declaration import JOINTS
from calibration.names.name import Array, Candidate, Scene, candidate


def coupling(s: Scene) -> list[Candidate]:
    """The inertia's off-diagonal terms, of every other joint alone and of all together.

    They are constant, as of an arm that hardly bends, or those of two links whose axes are parallel.
    Source: Craig, Introduction to Robotics, chapter 6.
    """
    joints = [name for name in JOINTS if name in s.view.columns]
    if not s.force or not s.view.dynamic:
        return []
    each = {name: _columns(s, name) for name in joints}
    sets = [[name] for name in joints] + ([joints] if len(joints) > 1 else [])
    return [_of(s, {name: each[name][:, :most] for name in some}) for some in sets for most in (1, None)]


def _of(s: Scene, columns: dict[str, Array]) -> Candidate:
    labels = [label for name, x in columns.items() for label in _labels(s, name)[: x.shape[1]]]
    note = f"the motion of {' and '.join(columns)} comes back here: inertia that couples them"
    return candidate(UNKNOWN, s.at(np.hstack([*columns.values()])), *labels, domain="time", note=note)


def _labels(s: Scene, joint: str) -> list[tuple[str, str]]:
    inertia, square = f"{s.unit} s2/{s.angle_unit}", f"{s.unit} s2/{s.angle_unit}2"
    bent = [f"acceleration_of_{joint}{by}" for by in ("", "_by_its_cos", "_by_own_cos")]
    rates = [f"{word}_{joint}" for word in ("square_of", "product_with", "own_square_of")]
    bent += [f"own_acceleration_by_cos_of_{joint}"] * _free(s)
    return [*((name, inertia) for name in bent), *((name, square) for name in rates)]


def _free(s: Scene) -> bool:
    """Whether the own acceleration may explain something: it is not the response itself."""
    return s.view.response.channel != "acceleration"


def _columns(s: Scene, joint: str) -> Array:
    """(n_full, 6 or 7): accelerations and products of both joints' rates, by the cos and sin of an angle."""
    v, turn = s.view, s.turn / (2 * np.pi)
    its, own = v.columns[joint], v.x
    rate, mine = v.smoothed(v.rate(its)), v.smoothed(v.rate(own))
    bent = v.smoothed(v.second(its))
    cos, own_cos = np.cos(its / turn), np.cos(own / turn)
    sin, own_sin = np.sin(its / turn), np.sin(own / turn)
    inertia = [bent, bent * cos, bent * own_cos, *[v.smoothed(v.second(own)) * cos] * _free(s)]
    return np.column_stack([*inertia, sin * rate**2, sin * rate * mine, own_sin * rate**2])
