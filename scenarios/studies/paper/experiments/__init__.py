"""The rows, one file each; E1 to E10 are the paper's experiments, E11 to E15 sentences of its text."""

from scenarios.studies.paper.experiments import (
    e01,
    e02,
    e03,
    e04,
    e05,
    e06,
    e07,
    e08,
    e09,
    e10,
    e11,
    e12,
    e13,
    e14,
    e15,
)
from scenarios.studies.paper.experiments.experiment import Experiment, Figures, Limit

EXPERIMENTS: tuple[Experiment, ...] = tuple(
    module.ROW for module in (e01, e02, e03, e04, e05, e06, e07, e08, e09, e10, e11, e12, e13, e14, e15)
)

__all__ = ["EXPERIMENTS", "Experiment", "Figures", "Limit"]
