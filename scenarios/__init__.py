"""Scenario files, their schema, the wiring, the runner and the command line."""

from scenarios.native import use
from scenarios.own import ours_first

ours_first()
use()
