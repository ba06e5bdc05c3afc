"""The guide log of a run's autoguide steps."""

from importlib.metadata import version

from host.logs.files import write_file
from host.logs.guidelog import hysteresis, opening, section
from scenarios.language.programme import guiding_of
from scenarios.run.outcome import Outcome


def write_guiding(outcome: Outcome) -> None:
    """Write guiding.txt, where a step has guided."""
    clock = outcome.scenario.clock
    sections = []
    for each in outcome.records:
        if each.guided and each.star is not None and each.start_s is not None:
            how = guiding_of(each.step.arguments)
            words = hysteresis(how.aggressiveness)
            sections.append(
                section(
                    each.step.name, each.start_s, each.star, clock, each.guided,
                    exposure_s=how.exposure_s, algorithm=words,
                )
            )  # fmt: skip
    if sections:
        text = "\n".join([opening(version("schmidt"), clock, 0.0), *sections])
        write_file(outcome.folder / "guiding.txt", text)
