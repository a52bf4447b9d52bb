"""
The light that falls on one vehicle: on its photodiodes, its panel and its hull.

What is called at every step is scalar or compiled; `lta_sim.light.field` says what the light is.
"""

from collections.abc import Sequence
from typing import final

from lta_sim.compiled import compiled
from lta_sim.light.field import Illuminance, LightField
from lta_sim.light.lambertian import beam, beams, Eye, lit, on_diodes, place, seen_all_round, shine
from lta_sim.sensors.light_block import AmplifierState, synthesise
from lta_sim.sensors.photodiode import PhotodiodeArray
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
        Where the panel is.
    diodes : PhotodiodeArray, optional
        Its diodes with gains as drawn for this flight; those of its file if left out.

    """

    def __init__(
        self, field: LightField, vehicle: Vehicle, diodes: PhotodiodeArray | None = None
    ) -> None:
        self.field = field
        self._diodes = diodes or vehicle.diodes
        x, y, z = vehicle.file.sensors.panel_position.vector
        self._panel = (x, y, z)
        self._beams = [beam(lamp, field.room) for lamp in field.lamps]
        self._lamps = beams(field)
        self._eye = Eye(self._diodes.response, self._diodes.edge)
        self._all_round = seen_all_round(self._eye)
        self._on_diodes = compiled(on_diodes)[0]
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
        shape = (len(self._poses), self._diodes.count)
        lamps = np.empty((len(self._lamps), *shape))
        poses = np.array(self._poses)
        self._on_diodes(self._lamps, self._eye, poses, self._diodes.planes, lamps)
        self._poses = [self._poses[-1]]
        light = Illuminance(
            lamps,
            np.full(shape, ambient.steady * self._all_round),
            np.full(shape, ambient.mains * self._all_round),
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
        return self._mean([lit(each, point, normal) for each in self._beams])

    def on_hull(self, pose: Pose) -> float:
        """Return the irradiance at the hull centre on planes that face each lamp. [W/m2]"""
        x, y, z = pose[:3]
        facing = [shine(each, (x, y, z))[0] + each.diffuse for each in self._beams]
        return self._mean(facing)[1]

    def _mean(self, modulated: Sequence[float]) -> tuple[float, float]:
        """Return illuminance and irradiance over the flicker, from each lamp's while it is on."""
        ambient = self.field.ambient
        lux, watts = ambient.steady, ambient.steady / ambient.efficacy
        for lamp, light in zip(self.field.lamps, modulated, strict=True):
            lux += light * lamp.wave.duty
            watts += light * (lamp.wave.duty / lamp.efficacy)
        return lux, watts
