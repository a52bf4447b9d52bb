# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Simple light for tests: a room's whole echo the same everywhere, and blocks of given light."""

from lta_model.light.field import PlaneIlluminance
from lta_model.light.lamp import direct_illuminance
from lta_model.sensors.photodiode_adc import PhotodiodeBoard
import numpy as np


def illuminance(field, points, normals):
    """Return the light of a scene on planes, shape (..., 3) each."""
    echo = [spread_evenly(lamp.flux, field.room) if field.room else 0.0 for lamp in field.lamps]
    lamps = zip(field.lamps, echo, strict=True)
    modulated = np.stack(
        [direct_illuminance(lamp, points, normals) + more for lamp, more in lamps]
    )
    even = np.ones(modulated.shape[1:])
    return PlaneIlluminance(modulated, field.ambient.steady * even, field.ambient.mains * even)


def spread_evenly(flux, room):
    """Return the light of all bounces in a room: a geometric series."""
    return flux * room.mean_albedo / (room.surface_area * (1.0 - room.mean_albedo))


def synthesise(array, field, light, start, sample_rate, samples, generator, state=None):
    """Return one block of a board that is made for it, and the state after it."""
    return PhotodiodeBoard(array, field, sample_rate, samples).sample_block(
        light, start, generator, state
    )
