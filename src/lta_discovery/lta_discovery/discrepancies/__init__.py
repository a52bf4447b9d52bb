"""Where and when the model of the vehicle file disagrees."""
