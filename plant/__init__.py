"""What the motors turn and the encoders see."""
