"""
The light that falls on one vehicle: on its photodiodes, its panel and its hull.

What is called at every step is scalar or compiled; `lta_sim.light_field` says what the light is.
"""

import math
from typing import final

from lta_sim.compiled import compiled
from lta_sim.lambertian import beam, lit, on_planes, place
from lta_sim.light_field import Illuminance, LightField
from lta_sim.sensors.light_block import AmplifierState, synthesise
from lta_sim.vehicle import Vehicle
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Pose = tuple[float, ...]  # position and quaternion x y z w
UP = (0.0, 0.0, 1.0)


@final
class LightView:
    """
    The light of a scene as one vehicle meets it.

    Parameters
    ----------
    field : LightField
        The scene.
    vehicle : Vehicle
        Where diodes and panel are.

    """

    def __init__(self, field: LightField, vehicle: Vehicle) -> None:
        self.field = field
        self._diodes = vehicle.diodes
        self._planes = vehicle.diodes.planes
        x, y, z = vehicle.file.sensors.panel_position.vector
        self._panel = (x, y, z)
        self._beam = beam(field)
        self._on_planes = compiled(on_planes)[0]
        self._poses: list[Pose] = []
        self._amplifier: AmplifierState | None = None

    def pass_by(self, pose: Pose) -> None:
        """Take note of the pose at a control step: the next block is seen from there."""
        self._poses.append(pose)

    def block(
        self, start_ns: int, sample_rate: float, samples: int, chance: Generator
    ) -> NDArray[np.uint16]:
        """Return the block that began at a time and ends now, from the poses since."""
        ambient = self.field.ambient
        lamp = np.empty((len(self._poses), self._diodes.count))
        self._on_planes(self._beam, np.array(self._poses), self._planes, lamp)
        self._poses = [self._poses[-1]]
        light = Illuminance(
            lamp, np.full(lamp.shape, ambient.steady), np.full(lamp.shape, ambient.mains)
        )
        block, self._amplifier = synthesise(
            self._diodes,
            self.field,
            light,
            start_ns,
            sample_rate,
            samples,
            chance,
            self._amplifier,
        )
        return block

    def on_panel(self, pose: Pose) -> tuple[float, float]:
        """Return illuminance [lx] and irradiance [W/m2] of the panel, mean over the flicker."""
        x, y, z, i, j, k, w = pose
        point, normal = place((x, y, z), (i, j, k, w), self._panel, UP)
        return self._mean(lit(self._beam, point, normal))

    def on_hull(self, pose: Pose) -> float:
        """Return the irradiance at the hull centre on a plane that faces the lamp. [W/m2]"""
        x, y, z = pose[:3]
        a, b, c = self._beam.x - x, self._beam.y - y, self._beam.z - z
        length = math.sqrt(a * a + b * b + c * c) or 1.0
        return self._mean(lit(self._beam, (x, y, z), (a / length, b / length, c / length)))[1]

    def _mean(self, modulated: float) -> tuple[float, float]:
        """Return illuminance and irradiance over the flicker, from the lamp's while it is on."""
        lamp, ambient = self.field.lamp, self.field.ambient
        return (
            modulated * lamp.wave.duty + ambient.steady,
            modulated * (lamp.wave.duty / lamp.efficacy) + ambient.steady / ambient.efficacy,
        )
