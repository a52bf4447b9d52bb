"""Detect faulty meter readings: one file for each fault, and all detectors together."""
