"""Battery, solar and load models, in-flight energy monitoring and mission energy budgets."""
