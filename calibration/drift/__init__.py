"""A position at constant rate, over time: a mount behind a guide log or an encoder less the sky."""
