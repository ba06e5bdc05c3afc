"""One source, two ways to run it: the rooms' Python as it is, or compiled by mypyc into a library beside it.

The library is used when it is there and was made of these very files; otherwise the same code runs plain.
`SCHMIDT_PURE=1` forces the plain way (debugger, coverage), `SCHMIDT_PURE=0` insists on the library.
`make compiled` (`python -m scenarios.native`) builds it.
"""

from scenarios.native.finder import compiled, use

__all__ = ["compiled", "use"]
