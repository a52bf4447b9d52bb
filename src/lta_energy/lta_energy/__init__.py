"""What it costs: battery, panel, loads and the energy books."""
