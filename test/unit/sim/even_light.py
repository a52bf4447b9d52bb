"""Simple light for tests: a room's whole echo the same everywhere, and blocks of given light."""

from lta_model.light.field import Illuminance
from lta_model.light.lamp import direct
from lta_model.sensors.light_block import Board
import numpy as np


def illuminance(field, points, normals):
    """Return the light of a scene on planes, shape (..., 3) each."""
    echo = [field.room.diffuse(lamp.flux) if field.room else 0.0 for lamp in field.lamps]
    lamps = zip(field.lamps, echo, strict=True)
    modulated = np.stack([direct(lamp, points, normals) + more for lamp, more in lamps])
    even = np.ones(modulated.shape[1:])
    return Illuminance(modulated, field.ambient.steady * even, field.ambient.mains * even)


def synthesise(array, field, light, start, sample_rate, samples, generator, state=None):
    """Return one block of a board that is made for it, and the state after it."""
    return Board(array, field, sample_rate, samples).block(light, start, generator, state)
