"""Run nodes again on recorded data, and compare their outputs with the recording."""
