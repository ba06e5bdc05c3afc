"""The paper's objective: 15 arcsec/s held within 1 arcsec/s, from every start."""
