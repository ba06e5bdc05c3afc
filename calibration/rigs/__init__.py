"""Rig files of measured drives; the data's paths are given on the command line."""
