"""A running network as bytes, and bytes as a running network."""
