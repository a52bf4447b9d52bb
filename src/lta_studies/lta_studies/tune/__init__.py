"""Tune controller gains over a range of helium losses and assess their robustness."""
