"""Propose a law, a sparse sum of terms, for a force that no effect of the library explains."""
