"""One function of a measured column in the place of several functions of the motion."""

from calibration.decide.parameters import finding_of
from calibration.decide.rules import OTHER_COLUMNS
from calibration.decide.select import select
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN, Finding
from calibration.names.scene import Scene
from calibration.names.unknown import smooth_functions

# of what several functions take off the held-out mean square, that one in their place takes. ASSUMPTION
AS_MUCH = 0.9


def by_one_column(
    s: Selection, together: Selection, findings: list[Finding], scene: Scene
) -> tuple[Selection, Selection, list[Finding]]:
    """What `beyond_names` gives, with one smooth function instead of several, of which one has no name.

    A load follows the place and the direction of the motion. What hangs on the load then looks like a sum of
    functions of both, none of which explains it.
    """
    if len(together.chosen) > 1 and any(c.name == UNKNOWN for c in together.candidates):
        scene.model = None
        columns = [c for c in smooth_functions(scene) if c.domain in OTHER_COLUMNS]
        alone = select(s.problem, columns, most=1)
        if alone.chosen and _taken(alone) > AS_MUCH * _taken(together):
            return s.keep([]), alone, [finding_of(alone, 0)]
    return s, together, findings


def _taken(s: Selection) -> float:
    """What is off the held-out mean square."""
    return s.held.before**2 - s.held.after**2
