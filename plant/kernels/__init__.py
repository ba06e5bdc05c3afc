"""Compiled kernels: flat arrays in, flat arrays out; nothing here knows a file, a name or a unit but SI."""
