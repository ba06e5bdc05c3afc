"""What runs on the microcontrollers: one package per board."""
