"""Benchmarks that need tools no room depends on."""

import scenarios  # noqa: F401  # before the other rooms: it finds the compiled library
