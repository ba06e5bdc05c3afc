"""Candidate effects: what each name of the catalogue would add to a channel, as regressors over known
domains."""
