"""Benchmarks that need tools no room depends on."""
