"""The vehicle model: vehicle, effects, sensors and scene light, independent of the simulator."""
