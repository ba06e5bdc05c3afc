"""The chips the boards are made of: integer registers on one side, pins (callables) on the other."""
