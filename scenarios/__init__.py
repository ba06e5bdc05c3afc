"""Scenario files, their schema, the wiring, the runner and the command line."""
