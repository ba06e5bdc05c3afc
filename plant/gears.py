"""The gear table: what turns how often per turn of the telescope axis (paper, section 2.2)."""

TRAIN = ((27, 113), (21, 123), (17, 250))
"""Three stages, pinion : wheel, from the motor to the axis."""
ROLLER = (735, 30)
"""Friction roller of the incremental encoder, wheel : roller."""
_AUXILIARY = 10.8
(_PINION1, _WHEEL1), (_PINION2, _WHEEL2), (_PINION3, _WHEEL3) = TRAIN
_SHAFT2 = _WHEEL3 / _PINION3
_SHAFT1 = _SHAFT2 * _WHEEL2 / _PINION2
_MOTOR = _SHAFT1 * _WHEEL1 / _PINION1

ORDERS: dict[str, float] = {
    "axis": 1.0, "aux": _AUXILIARY, "shaft2": _SHAFT2, "roller": ROLLER[0] / ROLLER[1], "shaft1": _SHAFT1,
    "mesh3": float(_WHEEL3), "motor": _MOTOR, "mesh2": _SHAFT2 * _WHEEL2, "mesh1": _MOTOR * _PINION1,
}  # fmt: skip
"""Cycles per axis turn of every stage, by name, slowest first.

`shaft2` carries the second wheel and the third pinion, `shaft1` the first wheel and the second pinion.
`mesh1` is the mesh at the motor, `mesh3` the one at the bull gear.
"""
RATIO: float = _WHEEL1 / _PINION1 * (_WHEEL2 / _PINION2) * (_WHEEL3 / _PINION3)
"""Motor turns per axis turn."""
