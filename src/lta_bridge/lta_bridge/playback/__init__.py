"""Playing a recording back into a graph: what, when, and whose answers are waited for."""
