"""The processes of lta_energy."""
