"""The model: vehicle, effects, sensors and the light of a scene. It knows no simulation."""
