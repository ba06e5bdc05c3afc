"""A scenario run, judged and reported."""
