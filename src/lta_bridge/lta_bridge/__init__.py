"""Recorder and player of bags, and links to real hardware."""
