"""Which names flights can tell apart, and the flight that would."""
