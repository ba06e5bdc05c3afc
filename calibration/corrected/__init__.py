"""From findings to the effects of a plant file."""
