"""Power control (B8): eight relays, supply voltage and current."""
