"""An effort in parts of a supply that is not steady."""

import numpy as np

from calibration.names.name import FORCE, VOLTS, Array, Candidate, Name, Scene, candidate

LEAST = 0.01  # part of the mean supply: standard deviation below which it is steady. ASSUMPTION
MOST = 3.0  # times the supply's deviation, that an effort may follow it by. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """Volts that the supply's resistance takes; of a force its declared part times the supply's deviation."""
    if lacks(s) or ("supply" in s.view.columns and s.windings is not None):
        return []
    if (w := s.windings) is not None:
        # bridges draw duty times current, or the sum of two currents, and give the duty of what is left
        drawn: list[tuple[Array, dict[str, tuple[float, str]]]] = [(w.duty * w.current, {})]
        if w.counter is not None:
            said = "0 currents drawn from the supply, 1 currents of the motors"
            drawn.append((w.current, {"of_the_sum": (1.0, said)}))
        volts = [(w.at(w.duty * w.together(x)), fixed) for x, fixed in drawn]
        return [candidate(NAME.name, one, "resistance", sign=1, fixed=fixed) for one, fixed in volts]
    supply = s.view.columns["supply"]
    column = (s.residual - s.problem.y) * s.at(supply / float(supply.mean()) - 1.0)
    return [candidate(NAME.name, column, ("share", "1"), sign=1, most=MOST)]


def lacks(s: Scene) -> str:
    """A supply column that changes; of a balance of volts a duty of a supply that is not logged."""
    if s.windings is not None:
        measured = s.windings.measured
        return "a column of the duty: measured volts have sagged already" if measured else ""
    if s.view.response.channel != "effort" or s.view.response.divide_by == "supply":
        return "an effort that is not over the supply already"
    supply = s.view.columns.get("supply")
    if supply is None:
        return "a column of the supply"
    mean = abs(float(supply.mean())) or 1.0
    return "" if float(np.std(supply)) > LEAST * mean else "a supply that changes by more than a percent"


NAME = Name(
    name="supply_sag",
    channels=(FORCE, VOLTS),
    columns=columns,
    experiment="record the supply voltage and divide by it, or feed the drive from a steady supply",
    lacks=lacks,
    nuisances={"of_the_sum": "found with the motors' currents, the plant draws duty times current"},
)
