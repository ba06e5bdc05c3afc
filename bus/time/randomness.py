"""Random numbers: one independent generator per object, from the master seed and the object's name."""

from hashlib import sha256

import numpy as np


def generator(seed: int, name: str) -> np.random.Generator:
    """A generator of `seed` and `name` only (SHA-256, so not of PYTHONHASHSEED or creation order)."""
    digest = sha256(f"{seed}:{name}".encode()).digest()
    return np.random.Generator(np.random.PCG64(int.from_bytes(digest, "little")))
