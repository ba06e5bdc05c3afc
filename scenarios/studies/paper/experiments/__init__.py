"""The rows, one file each; E1 to E10 are the paper's experiments, E11 to E15 sentences of its text."""

from importlib import import_module

from scenarios.studies.paper.experiments.experiment import Experiment, Figures, Limit

EXPERIMENTS: tuple[Experiment, ...] = tuple(
    import_module(f"{__package__}.e{number:02d}").ROW for number in range(1, 16)
)

__all__ = ["EXPERIMENTS", "Experiment", "Figures", "Limit"]
