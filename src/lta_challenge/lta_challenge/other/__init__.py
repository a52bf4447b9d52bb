"""Cases of the row `other`: a simulator that shares no code and no equations with the model."""
