"""Light on small planes with a room's whole echo the same everywhere: simple scenes for tests."""

from lta_sim.light.field import Illuminance
from lta_sim.light.lamp import direct
import numpy as np


def illuminance(field, points, normals):
    """Return the light of a scene on planes, shape (..., 3) each."""
    echo = [field.room.diffuse(lamp.flux) if field.room else 0.0 for lamp in field.lamps]
    lamps = zip(field.lamps, echo, strict=True)
    modulated = np.stack([direct(lamp, points, normals) + more for lamp, more in lamps])
    even = np.ones(modulated.shape[1:])
    return Illuminance(modulated, field.ambient.steady * even, field.ambient.mains * even)
