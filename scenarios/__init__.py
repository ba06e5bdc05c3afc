"""Scenario files, their schema, the wiring, the runner and the command line."""

from scenarios.native import use

use()
