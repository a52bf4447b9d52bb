"""What the world does: vehicle, physical effects, light field and sensors."""
