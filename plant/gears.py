"""The gear table: what turns how often per turn of the telescope axis (paper, section 2.2).

Orders are computed from the tooth counts, so that calibration can ask for "one tooth more" and get a table
for it.
"""

# paper 2.2: three stages, pinion : wheel, from the motor to the axis
TRAIN: tuple[tuple[int, int], ...] = ((27, 113), (21, 123), (17, 250))
# paper 2.2: friction roller of the incremental encoder, wheel : roller
ROLLER: tuple[int, int] = (735, 30)
# paper 2.2: auxiliary encoder, 1:10.8
AUXILIARY: float = 10.8


def ratio(train: tuple[tuple[int, int], ...] = TRAIN) -> float:
    """Return motor turns per axis turn."""
    result = 1.0
    for pinion, wheel in train:
        result *= wheel / pinion
    return result


def orders(
    train: tuple[tuple[int, int], ...] = TRAIN, roller: tuple[int, int] = ROLLER, auxiliary: float = AUXILIARY
) -> dict[str, float]:
    """Return cycles per axis turn of every stage, by name, slowest first.

    `shaft2` carries the second wheel and the third pinion, `shaft1` the first wheel and the second pinion.
    `mesh1` is the mesh at the motor, `mesh3` the one at the bull gear.
    """
    (pinion1, wheel1), (pinion2, wheel2), (pinion3, wheel3) = train
    shaft2 = wheel3 / pinion3
    shaft1 = shaft2 * wheel2 / pinion2
    motor = shaft1 * wheel1 / pinion1
    return {
        "axis": 1.0,
        "aux": auxiliary,
        "shaft2": shaft2,
        "roller": roller[0] / roller[1],
        "shaft1": shaft1,
        "mesh3": float(wheel3),
        "motor": motor,
        "mesh2": shaft2 * wheel2,
        "mesh1": motor * pinion1,
    }


ORDERS: dict[str, float] = orders()
RATIO: float = ratio()
