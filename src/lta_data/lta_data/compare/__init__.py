"""Compare two flights: align their clocks and frames, and find where and when they diverge."""
