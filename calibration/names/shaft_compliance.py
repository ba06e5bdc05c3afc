"""A shaft that winds up with the torque it carries."""

from calibration.names.name import SENSORS, Candidate, Changed, Name, Scene, candidate

PRECISE = 0.05  # standard error of a stiffness, of itself. ASSUMPTION
WINDS = ("force", "effort", "current")  # columns of what winds it up, the first there is


def columns(s: Scene) -> list[Candidate]:
    """The effort, as it goes through the shaft between two sensors."""
    for channel in WINDS:
        if channel in s.view.columns:
            label = ("compliance", f"{s.unit}/{s.view.rig.columns[channel].unit}")
            return [candidate("shaft_compliance", s.at(s.view.columns[channel]), label)]
    return []


NAME = Name(
    name="shaft_compliance",
    channels=(SENSORS,),
    columns=columns,
    experiment="lock the output and step the torque: play is a step, compliance a line",
    lacks=lambda s: (
        "" if {*WINDS} & {*s.view.columns} else "a column of the effort, the current or the force"
    ),
    changed=Changed(numbers={"stiffness": "stiffness"}, precise={"stiffness": PRECISE}),
)
