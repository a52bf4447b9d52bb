"""Wire, synchronise, monitor and launch the LTA nodes."""
