"""Where the telescope truly looks at one moment."""

from typing import NamedTuple


class Look(NamedTuple):
    """One sample of the truth. Angles are observed ones, rad, hour angle positive west.

    t_ns: simulated time. roll_rad: from north to the camera's upper edge, positive through west. focus_m: of
    the focus from the middle of its travel.
    """

    t_ns: int
    hour_angle_rad: float
    declination_rad: float
    roll_rad: float = 0.0
    focus_m: float = 0.0
