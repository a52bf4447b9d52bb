"""Closed loops by the thousand: one text for the processor's cores and for a GPU."""
