"""The rows: E1 to E10 are the paper's experiments, E11 to E15 sentences of its text."""

from scenarios.studies.paper.experiments import closed, friction, models, opened
from scenarios.studies.paper.experiments.experiment import Experiment, Figures, Limit

EXPERIMENTS: tuple[Experiment, ...] = (
    closed.low_preload, closed.high_preload, closed.higher_speeds, closed.slow_slews,
    opened.higher_speeds, opened.slowest, friction.table_2, friction.inertia, models.equation_6,
    models.tuning_rules, closed.low_gains, friction.viscous_branch, closed.negligible, friction.at_rest,
    closed.both_preloads,
)  # fmt: skip

__all__ = ["EXPERIMENTS", "Experiment", "Figures", "Limit"]
