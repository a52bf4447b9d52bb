"""Reproduce the seed paper and compare each of its claims with our results."""
