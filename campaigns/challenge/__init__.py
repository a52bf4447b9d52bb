"""Hide effects in flights of a simulator that shares no equation with the model, and score."""
