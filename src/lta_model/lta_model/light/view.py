# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute the share of a lamp's light that the surfaces of a room reflect.

The light on each face is summed over a grid. In a room without a door all of the flux reaches its
faces, so there the sum is scaled to the known total.

Light on one vehicle: on its photodiodes, its panel and its hull.

Code called at every step is scalar or compiled; `lta_model.light.field` describes the light.
Direct light is computed at every control step, everything else at the ends of a block.
"""

from collections.abc import Sequence
from functools import lru_cache
import math
from typing import final, NamedTuple

from lta_config.compilation.compiler import compile_functions
from lta_model.electrical.panel import array_spectral_factor
from lta_model.light.direct_light import build_beam, DiodeResponse, direct_light, LampBeam
from lta_model.light.field import LightField, PlaneIlluminance
from lta_model.light.lamp import BeaconLamp
from lta_model.light.readings import (
    build_panel_plane,
    daylight_on_panel,
    lamp_light_on_panel,
    write_pose_readings,
)
from lta_model.light.reflected_light import (
    gather_indirect_light,
    LAMP_ROWS,
    reflected_luminance,
    scratch_size,
    UNIFORM_ROW,
)
from lta_model.light.scene_geometry import (
    build_scene_geometry,
    daylight_illuminance,
    is_in_door,
    is_in_room,
    RayHit,
    SceneGeometry,
)
from lta_model.mass_properties import half_axes
from lta_model.sensors.photodiode import PhotodiodeArray, voltage_sensitivity
from lta_model.sensors.photodiode_adc import AmplifierState, PhotodiodeBoard
from lta_model.vehicle import Vehicle
import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

FACE_CELLS = 64  # cells along each edge of a face


def build_field_geometry(field: LightField) -> SceneGeometry:
    """Return room, door and daylight of a scene as numbers."""
    return build_scene_geometry(field.room, field.daylight, field.outside)


def integrate_reflected_flux(s: SceneGeometry, lamp: LampBeam, cells: int) -> tuple[float, float]:
    """Return a lamp's flux on all faces of a room, and the reflected part of it [lm]."""
    # Midpoint rule over a grid on each face
    fallen, thrown = 0.0, 0.0
    for face in range(6):
        for row in range(cells):
            for column in range(cells):
                # Cell centres, -1 to 1 across a face
                a = 2.0 * (row + 0.5) / cells - 1.0
                b = 2.0 * (column + 0.5) / cells - 1.0
                side = 1.0 if face % 2 == 0 else -1.0
                up = 0.5 * s.height * (1.0 + b)
                # Ceiling and floor, then the walls across x, then those across y
                if face < 2:
                    albedo = s.ceiling if side > 0.0 else s.floor
                    height = s.height if side > 0.0 else 0.0
                    # Albedo 1, to get the incident flux
                    met = RayHit(a * s.x, b * s.y, height, 0.0, 0.0, -side, 1.0)
                    area = 4.0 * s.x * s.y
                elif face < 4:
                    albedo = s.walls
                    met = RayHit(side * s.x, a * s.y, up, -side, 0.0, 0.0, 1.0)
                    area = 2.0 * s.y * s.height
                    # Light leaves through the door
                    if is_in_door(s, met.x, met.y, met.z):
                        albedo = 0.0
                else:
                    albedo = s.walls
                    met = RayHit(a * s.x, side * s.y, up, 0.0, -side, 0.0, 1.0)
                    area = 2.0 * s.x * s.height
                flux = reflected_luminance(s, met, lamp) * area / (cells * cells)
                fallen += flux
                thrown += albedo * flux
    return fallen, thrown


@lru_cache(maxsize=256)
def build_reflecting_beam(lamp: BeaconLamp, field: LightField) -> LampBeam:
    """Return a lamp of a scene as numbers, with the light reflected by the room."""
    bare = build_beam(lamp)
    if field.room is None or not lamp.flux:
        return bare
    fallen, thrown = compile_functions(integrate_reflected_flux)[0](
        build_field_geometry(field), bare, FACE_CELLS
    )
    # Closed room: scale to the known total flux
    if field.outside is None and fallen > 0.0:
        thrown *= lamp.flux / fallen
    return build_beam(lamp, field.room, thrown)


def pack_beams(field: LightField) -> NDArray[np.float64]:
    """Return the lamps of a scene, a row each in the order of `LampBeam`, shape (l, 11)."""
    return np.array([build_reflecting_beam(lamp, field) for lamp in field.lamps])


Array = NDArray[np.float64]
Pose = tuple[float, ...]  # position and quaternion x y z w


class LightWeights(NamedTuple):
    """Factors of the irradiances of each lamp, of ambient light and of daylight [1]."""

    lamps: tuple[float, ...]
    ambient: float
    day: float

    @classmethod
    def even(cls, lamps: int) -> 'LightWeights':
        """Return the factors 1 for so many lamps."""
        return cls((1.0,) * lamps, 1.0, 1.0)


def find_spectral_weights(field: LightField, vehicle: Vehicle) -> LightWeights:
    """Return what the solar cells of a vehicle make of the spectra in a scene."""
    energy = vehicle.file.energy
    daylight = field.any_daylight
    return LightWeights(
        tuple(array_spectral_factor(energy, lamp.efficacy) for lamp in field.lamps),
        array_spectral_factor(energy, field.ambient.efficacy),
        1.0 if daylight is None else array_spectral_factor(energy, daylight.efficacy),
    )


@final
class LightView:
    """
    The light of a scene as one vehicle receives it.

    `diodes` have the gains drawn for this flight; by default they are those of the vehicle's file.
    """

    def __init__(
        self, field: LightField, vehicle: Vehicle, diodes: PhotodiodeArray | None = None
    ) -> None:
        self.field = field
        self._diodes = diodes or vehicle.diodes
        self._beams = [build_reflecting_beam(lamp, field) for lamp in field.lamps]
        eye = DiodeResponse(self._diodes.response, self._diodes.edge_cosine)
        self._surround = build_field_geometry(field)
        hull = half_axes(vehicle.file.hull)
        self._scene = (self._surround, pack_beams(field), eye, hull)
        self._panel = build_panel_plane(hull, vehicle.file.panel_place, vehicle.file.panel_normal)
        self._spectral = find_spectral_weights(field, vehicle)
        self._gather, self._on_the_way = compile_functions(
            gather_indirect_light, write_pose_readings
        )
        self._poses: list[Pose] = []
        # Reused at every block
        self._scratch = np.empty(scratch_size(len(self._beams)))
        self._around: Array | None = None  # what was gathered at the end of the block before
        ambient = field.ambient
        self._ambient = ambient.steady, ambient.mains, self._daylight_reading
        self._board: PhotodiodeBoard | None = None
        self._amplifier: AmplifierState | None = None

    def prepare(self, sample_rate: float, samples: int) -> None:
        """Compile the block sampling (sample rate in Hz) before the first block."""
        # The first call compiles; its results are discarded
        saved = self._poses, self._around, self._amplifier
        self._poses = [(0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)] * 2
        self.sample_light_block(0, sample_rate, samples, np.random.default_rng(0))
        self._poses, self._around, self._amplifier = saved

    def record_pose(self, pose: Pose) -> None:
        """Record the pose at a control step for the next block."""
        self._poses.append(pose)

    def sample_light_block(
        self, start_ns: int, sample_rate: float, samples: int, chance: Generator
    ) -> NDArray[np.uint16]:
        """Return the block that began at a time [ns], shape (samples, diodes) [Hz; counts]."""
        light = self.compute_diode_readings(self._poses)
        # The next block starts where this one ended
        self._poses = [self._poses[-1]]
        board = self._board
        # Rebuilt only if the block format changes
        if board is None or board.sampling != (sample_rate, samples):
            board = self._board = PhotodiodeBoard(self._diodes, self.field, sample_rate, samples)
        block, self._amplifier = board.sample_block(light, start_ns, chance, self._amplifier)
        return block

    def compute_diode_readings(self, poses: Sequence[Pose]) -> PlaneIlluminance:
        """Return the diodes' readings at a sequence of poses."""
        # The end of the last block is the start of this one
        before = self._compute_indirect_light(poses[0]) if self._around is None else self._around
        self._around = after = self._compute_indirect_light(poses[-1])
        shape = len(poses), self._diodes.count
        light = PlaneIlluminance(
            np.empty((len(self._beams), *shape)), np.empty(shape), np.empty(shape)
        )
        self._on_the_way(
            *self._scene,
            np.array(poses),
            self._diodes.planes,
            before,
            after,
            self._ambient,
            light.modulated,
            light.steady,
            light.mains,
        )
        return light

    @property
    def _daylight_efficacy(self) -> float:
        """Luminous efficacy of the daylight; infinite if there is none [lm/W]."""
        daylight = self.field.any_daylight
        return math.inf if daylight is None else daylight.efficacy

    @property
    def _daylight_reading(self) -> float:
        """Lux of the ambient light that the diodes read like one of daylight."""
        efficacy = self._daylight_efficacy
        if math.isinf(efficacy):
            return 0.0
        ambient = voltage_sensitivity(self._diodes, self.field.ambient.efficacy)
        return voltage_sensitivity(self._diodes, efficacy) / ambient

    def _compute_indirect_light(self, pose: Pose) -> Array:
        """Return the indirect light at a pose, without ambient light beyond a door."""
        x, y, z, i, j, k, w = pose
        out = np.empty((LAMP_ROWS + len(self._beams), self._diodes.count))
        self._gather(
            *self._scene, (x, y, z), (i, j, k, w), self._diodes.planes, out, self._scratch
        )
        if not self._has_ambient_light(pose):
            # Ambient light is the room's; outdoors there is daylight instead
            out[UNIFORM_ROW] = 0.0
        return out

    def _has_ambient_light(self, pose: Pose) -> bool:
        """Return whether ambient light reaches a pose."""
        return self.field.outside is None or is_in_room(self._surround, *pose[:3])

    def panel_light(self, pose: Pose) -> tuple[float, float]:
        """
        Return illuminance [lx] and irradiance [W/m2] of the panel, mean over the flicker.

        The irradiance is that of sunlight which gives the cells the same current.
        """
        x, y, z, i, j, k, w = pose
        s, panel, position, q = self._surround, self._panel, (x, y, z), (i, j, k, w)
        modulated = [lamp_light_on_panel(panel, s, each, position, q) for each in self._beams]
        return self._average_flicker(
            pose, modulated, daylight_on_panel(panel, s, position, q), panel.share, self._spectral
        )

    def hull_irradiance(self, pose: Pose) -> float:
        """Return the irradiance at the hull centre on planes that face each light [W/m2]."""
        x, y, z = pose[:3]
        # The hull is taken as facing every light, without shade
        facing = [direct_light(each, (x, y, z))[0] + each.diffuse for each in self._beams]
        s = self._surround
        return self._average_flicker(
            pose,
            facing,
            daylight_illuminance(s, (x, y, z), (s.sun_x, s.sun_y, s.sun_z)),
            1.0,
            LightWeights.even(len(self._beams)),
        )[1]

    def _average_flicker(
        self,
        pose: Pose,
        modulated: Sequence[float],
        day: float,
        share: float,
        weights: LightWeights,
    ) -> tuple[float, float]:
        """
        Return illuminance [lx] and irradiance [W/m2], averaged over the flicker.

        From each lamp's light while it is on, daylight [lx], the share of ambient light, and the
        factors of their irradiances.
        """
        ambient = self.field.ambient
        steady = share * ambient.steady if self._has_ambient_light(pose) else 0.0
        lux = steady + day
        watts = weights.ambient * steady / ambient.efficacy
        watts += weights.day * day / self._daylight_efficacy
        for lamp, light, weight in zip(self.field.lamps, modulated, weights.lamps, strict=True):
            # Mean over the period of the lamp
            lux += light * lamp.wave.duty
            watts += weight * light * (lamp.wave.duty / lamp.efficacy)
        return lux, watts
