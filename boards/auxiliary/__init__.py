"""Auxiliary encoder board (P10, B8): the A25s behind 1:10.8, one per axis."""
