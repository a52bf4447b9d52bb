"""Flights: one in one process, the whole graph, many in a sweep, a recorded one again."""
