"""One function of a load, or of a temperature, in the place of several functions of the motion."""

from calibration.decide.drive import OTHER_COLUMNS
from calibration.decide.parameters import finding_of
from calibration.decide.select import select
from calibration.decide.selection import Refusal, Selection
from calibration.decide.thresholds import AS_MUCH, STILL_MISSING
from calibration.finding import UNKNOWN, Finding
from calibration.names.scene import Scene
from calibration.names.unknown import smooth_functions


def by_one_column(
    s: Selection, together: Selection, findings: list[Finding], scene: Scene
) -> tuple[Selection, Selection, list[Finding]]:
    """The answer of `beyond_names` with one smooth function instead of several, of which one has no name.

    A load follows the place and the direction of the motion. What hangs on the load then looks like a sum of
    functions of both, none of which explains it. Names of such a column stay that leave as little.
    """
    if len(together.chosen) > 1 and any(c.name == UNKNOWN for c in together.candidates):
        model, scene.model = scene.model, None
        columns = [c for c in smooth_functions(scene) if c.domain in OTHER_COLUMNS]
        alone = select(s.problem, columns, most=1, before=s.looked_at)
        scene.model = model
        as_little = alone.held.after <= STILL_MISSING * max(together.held.after, s.problem.floor)
        theirs = s.keep([x for x in s.chosen if x.candidate.domain in OTHER_COLUMNS])
        if theirs.chosen and theirs.held.after <= STILL_MISSING * alone.held.after:
            return s, together, findings
        if alone.chosen and as_little and alone.held.taken > AS_MUCH * together.held.taken:
            why = f"{alone.candidates[0].say()} over {alone.candidates[0].domain} alone takes as much"
            instead = [Refusal(c.say(), why) for c in together.candidates]
            alone.refused = [*s.refused, *instead, *alone.refused]
            return s.keep([]), alone, [finding_of(alone, 0)]
    return s, together, findings
