"""Flights: in one process, as a graph of nodes, in sweeps, and replays of recordings."""
