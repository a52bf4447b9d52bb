"""Two flights beside each other: their clocks, their frames, and where and when they part."""
