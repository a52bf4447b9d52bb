"""Several nodes in one process."""

from lta_graph.interrupts import guard_start

guard_start(__name__)
