"""Bearing accuracy of our estimator and the paper's."""
