"""Where a star is seen from the site, and where the telescope's axes have to stand for it."""
