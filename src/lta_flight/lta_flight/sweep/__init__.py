"""Many flights of one design: planned, flown by many processes, kept, tabled and drawn."""
