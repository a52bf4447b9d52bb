"""Sensor models of the simulation that are not in `lta_model.sensors`."""
