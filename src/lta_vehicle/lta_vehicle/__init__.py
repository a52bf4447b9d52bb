"""What a vehicle is and can do, in words and pictures; how two differ; what a flight weighed."""
