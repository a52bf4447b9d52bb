"""Sweeps of many flights: plan, fly in parallel, log, tabulate and plot."""
