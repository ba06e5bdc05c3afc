"""What the observer makes the telescope do, one generator per procedure."""
