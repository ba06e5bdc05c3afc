"""What is between the boards: time, CAN frames, the protocol and its doors."""
