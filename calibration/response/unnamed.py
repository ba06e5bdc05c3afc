"""What no name explains: smooth functions of a domain, and lines that the balance's filter takes away."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.channels.pickup import pick_up
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.decide.judge import design, phases
from calibration.decide.parameters import finding_of
from calibration.decide.select import Selection, select
from calibration.finding import Finding, Parameter
from calibration.names.scene import Scene
from calibration.names.unknown import smooth_functions
from calibration.response.left import left_over
from calibration.response.prune import CLEAR_SHARE, CLEAR_Z, beside, displaced

# smooth functions at most: of a force one, which imitates most names; of two sensors one over the place and
# one of either flank of the teeth
MOST = {True: 1, False: 2}


def beyond_names(s: Selection, scene: Scene, seed: int) -> tuple[Selection, Selection, list[Finding]]:
    """The named effects that stay, the same together with smooth functions, and these as findings; what was
    refused is added to the selection of the names."""
    together = s
    findings: list[Finding] = []
    floor = s.problem.floor
    little = scene.force and bool(floor) and left_over(s, scene, floor) is None
    if little and s.chosen:  # the names leave what is not called missing either
        return s, s, []
    below = little and s.held.before <= floor
    for _ in range(MOST[scene.force]):
        base = design(s.problem, [x.candidate for x in together.chosen])
        scene.model = np.asarray(base @ together.after.beta)
        offered = smooth_functions(scene)
        if scene.force:  # one by one; of two sensors what is left of the best is no second function
            offered = [replace(c, apart=float(k)) for k, c in enumerate(offered)]
        own = tuple(phases(s.problem, [x.candidate for x in together.chosen]))
        beside_names = replace(s.problem, base=base, base_phases=own)
        more = select(beside_names, offered, np.random.default_rng(seed), most=1)
        s.refused += more.refused
        # below the floor of a coarse sensor most of what is left must go with it
        if not more.chosen or (below and not (more.held.share > CLEAR_SHARE and more.held.z > CLEAR_Z)):
            break
        kept = displaced(s, more.chosen[0].candidate) if not findings else s
        if kept is not s:
            s, together = kept, beside(kept, more)
            findings.append(finding_of(together, len(kept.chosen)))
            continue
        findings.append(finding_of(more, 0))
        together = _together(together, more)
    return s, together, findings


def _together(s: Selection, more: Selection) -> Selection:
    """The named effects and the unnamed function as one selection, so that table and pictures agree."""
    share = 1 - (more.held.after / s.held.before) ** 2
    return replace(
        s,
        chosen=[*s.chosen, *more.chosen],
        classes=[*s.classes, *more.classes],
        steps=[*s.steps, *more.steps],
        after=more.after,
        held=replace(s.held, after=more.held.after, share=share, z=more.held.z),
    )


def quick_lines(view: View, problem: Problem) -> list[Finding]:
    """A line in the response's column that the filter takes away before any name is looked for."""
    line = pick_up(view) if view.dynamic else None
    if line is None:
        return []
    note = f"{line.frequency:.5g} Hz in the column itself: the filter takes it away, no error shows it"
    return [
        Finding(
            "unknown",
            problem.channel,
            "time",
            frequency=line.frequency,
            note=note,
            parameters={"amplitude": Parameter(line.amplitude, problem.unit)},
        )
    ]
