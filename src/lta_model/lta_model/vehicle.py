# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Derive a vehicle's physical properties from its file.

Mass, centre of gravity and inertia follow from the parts, the gas and the trim ballast
(`mass_properties`), or from its weighing; added mass from the hull's shape (`hull`), the wrench of
the rotors from wind tunnel or geometry (`propulsion`). Everything is about the hull centre, body
frame.
"""

from collections.abc import Sequence
from functools import cached_property
from typing import final

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.files import find_file, parse_yaml, validate_content
from lta_config.schema.vehicle_file import load_vehicle_file, VehicleFile
from lta_model import effect_parameters, mass_properties, propulsion
from lta_model.electrical.battery import BatteryModel
from lta_model.electrical.loads import LoadModel
from lta_model.electrical.mppt_charger import ChargerModel
from lta_model.electrical.panel import SolarArrayModel
from lta_model.mass_properties import (
    Array,
    build_gas_element,
    build_part_element,
    MassElement,
    MassProperties,
)
from lta_model.model import check_time_step, VehicleModel
from lta_model.sensors.photodiode import PhotodiodeArray
from lta_model.state import COMMAND, MASS_PLACE
import numpy as np

Vector = tuple[float, ...]


@final
class Vehicle:
    """
    One vehicle in air of a given density [kg/m3].

    Raises
    ------
    BadInput
        If the parts are too heavy for the lift, the centre of gravity is above the hull centre
        (and the file does not allow it), or an effect or one of its parameters is invalid.

    """

    def __init__(self, file: VehicleFile, air_density: float = AIR_DENSITY) -> None:
        self.file = file
        self.air_density = air_density
        if self.ballast_mass < 0.0:
            raise BadInput(
                f'The parts of {file.name} are {-1e3 * self.ballast_mass:.1f} g too heavy for its '
                f'lift of {1e3 * self.gross_lift:.1f} g and its trim.heaviness; make parts '
                'lighter, the hull larger, or raise trim.heaviness.'
            )
        if self.displaced_mass < 0.0:
            raise BadInput(
                f'{file.name} cannot be heavier than air by more than its own measured mass of '
                f'{1e3 * self.mass:.1f} g; lower trim.heaviness.'
            )
        if self.cg[2] >= 0.0 and file.hull.shape != 'none' and file.trim.unstable == 'refused':
            raise BadInput(
                f'{file.name} has its centre of gravity {100 * self.cg[2]:.1f} cm above '
                'the hull centre and would flip over; move mass down, or allow it with '
                '"unstable: allowed" under trim.'
            )
        self.build_model()  # refuses effects and parameters that do not exist or are out of bounds

    @property
    def volume(self) -> float:
        """Volume of the hull. [m3]."""
        return mass_properties.hull_volume(self.file.hull)

    @property
    def gas_mass(self) -> float:
        """Mass of the gas, helium with the rest of the purity being air. [kg]."""
        return mass_properties.gas_mass(self.file.hull, self.air_density)

    @property
    def gross_lift(self) -> float:
        """Gross lift of the hull: displaced air less gas. [kg]."""
        return self.volume * self.air_density - self.gas_mass

    @property
    def heaviness(self) -> float:
        """Mass less displaced air: what the rotors carry. [kg]."""
        heaviness = self.file.trim.heaviness
        return heaviness.si if heaviness else self.mass - self.volume * self.air_density

    @property
    def displaced_mass(self) -> float:
        """Mass of the displaced air; a weighed vehicle is filled until it is right. [kg]."""
        # The gas fill is adjusted until mass less displaced air is the declared heaviness
        if self.file.measured and self.file.trim.heaviness:
            return self.mass - self.file.trim.heaviness.si
        return self.volume * self.air_density

    @property
    def ballast_mass(self) -> float:
        """Mass that trims the parts to the declared heaviness. [kg]."""
        if self.file.measured or self.file.trim.heaviness is None:
            return 0.0
        moving = self.file.moving_mass
        parts = sum(part.mass.si for part in self.file.parts.values())
        carried = self.gross_lift + self.file.trim.heaviness.si - parts
        return carried - moving.mass.si if moving else carried

    @cached_property
    def mass_elements(self) -> list[MassElement]:
        """Components of a vehicle that was not weighed: parts, ballast and gas."""
        lumps = [build_part_element(part) for part in self.file.parts.values()]
        if place := self.file.trim.ballast_position:
            lumps.append(MassElement(self.ballast_mass, np.array(place.vector), np.zeros(3)))
        if self.file.hull.shape != 'none':
            lumps.append(
                build_gas_element(self.gas_mass, mass_properties.half_axes(self.file.hull))
            )
        return lumps

    @cached_property
    def mass_properties(self) -> MassProperties:
        """Mass, centre of gravity and inertia; a moving mass at rest included."""
        weighed = self.file.measured
        balance = (
            MassProperties.from_measurement(weighed)
            if weighed
            else MassProperties.from_elements(self.mass_elements)
        )
        if moving := self.file.moving_mass:
            place = np.array(moving.position.vector)
            balance = balance.with_element(MassElement(moving.mass.si, place, np.zeros(3)))
        return balance

    @property
    def mass(self) -> float:
        """Mass of everything, gas included. [kg]."""
        return self.mass_properties.mass

    @property
    def cg(self) -> Array:
        """Centre of gravity, gas included, from the hull centre, shape (3,). [m]."""
        return self.mass_properties.cg

    @property
    def inertia(self) -> Array:
        """
        Inertia about the centre of gravity, shape (3, 3). [kg m2].

        Gas that turns along is not in it (effect `gas_rotation`).
        """
        return self.mass_properties.inertia

    @property
    def added_mass(self) -> Vector:
        """Return the added mass and inertia, published or of a spheroid hull [kg, kg m2]."""
        return mass_properties.added_mass(self.file.hull, self.air_density)

    @cached_property
    def rotors(self) -> tuple[propulsion.RotorModel, ...]:
        """Return the rotors in the order of `motors`."""
        return propulsion.build_rotors(self.file)

    @property
    def rotor_names(self) -> list[str]:
        """Actuator names in the order of `motors`."""
        return list(self.file.rotors)

    @cached_property
    def reversible(self) -> tuple[bool, ...]:
        """Whether each rotor accepts negative duty."""
        return tuple(rotor.reversible for rotor in self.rotors)

    @cached_property
    def thrust_curve(self) -> tuple[float, float]:
        """Coefficients a and b of T = a u^2 + b u, the same for all rotors. [N]."""
        curves = {(rotor.a, rotor.b) for rotor in self.rotors}
        # Control laws invert a single curve
        if len(curves) != 1:
            raise BadInput(
                f'The rotors of {self.file.name} have {len(curves)} different thrust curves, '
                'but this control law needs the same curve for all; choose another control law.'
            )
        return curves.pop()

    @property
    def battery_compensated(self) -> bool:
        """
        Whether the firmware corrects duties for the battery voltage.

        A duty is then a share of a thrust: the file switches on the effect `battery_compensation`.
        """
        return self.collect_effects().get('battery_compensation', {}).get('voltage', 0.0) > 0.0

    @property
    def full_thrust(self) -> float:
        """Thrust of one rotor at full duty. [N]."""
        return sum(self.thrust_curve)

    @cached_property
    def allocation(self) -> tuple[Vector, ...]:
        """B as columns, one a rotor: wrench about the hull centre per newton. [1, m]."""
        return tuple(rotor.column for rotor in self.rotors)

    @cached_property
    def diodes(self) -> PhotodiodeArray:
        """Return the photodiodes with the gains of the file, before the spread is drawn."""
        ring = self.file.sensors.diodes
        return PhotodiodeArray(
            count=ring.count,
            # The file has the height over the hull centre
            depth=-ring.height.si,
            radius=ring.radius.si,
            axes=tuple((x, y, z) for x, y, z in ring.axes.value) if ring.axes else (),
            response=ring.response.si,
            field_of_view=ring.field_of_view.si,
            gain_spread=ring.gain_spread.si,
            gains=tuple(ring.gains.value) if ring.gains else (),
            dead=tuple(ring.dead),
            feedback_resistance=ring.feedback.si,
            bandwidth=ring.bandwidth.si,
            noise=ring.noise.si,
            adc_bits=ring.bits,
            adc_range=ring.full_scale.si,
            output_limit=ring.output_limit,
            adc_noise=ring.converter_noise.si,
            clock_error=ring.clock_error.si,
            jitter=ring.jitter.si,
        )

    @cached_property
    def battery(self) -> BatteryModel:
        """Return the cell."""
        return BatteryModel.from_energy(self.file.energy)

    @cached_property
    def loads(self) -> LoadModel:
        """Return the consumers."""
        return LoadModel.from_energy(self.file.energy)

    @cached_property
    def panel(self) -> SolarArrayModel:
        """Return the solar panels."""
        return SolarArrayModel.from_energy(self.file.energy)

    @cached_property
    def charger(self) -> ChargerModel:
        """Charger between panels and cell."""
        return ChargerModel.from_energy(self.file.energy)

    def collect_effects(self) -> dict[str, dict[str, float]]:
        """Return the parameters of every effect that is on, in SI."""
        return effect_parameters.collect_effects(
            self.file, self.rotors, self.added_mass, self.air_density
        )

    def build_model(self, around: effect_parameters.Effects | None = None) -> VehicleModel:
        """Return the kernel's numbers; `around` are effects of the surroundings."""
        return VehicleModel.build(
            self.collect_effects() | (around or {}),
            mass=self.mass,
            cg=self.cg,
            inertia=self.inertia,
            displaced=self.displaced_mass,
            rotors=[(rotor.place, rotor.axis) for rotor in self.rotors],
        )

    def pack_command(self, duties: Sequence[float]) -> Array:
        """Return a command, shape (COMMAND,): duties, then the moving mass at its rest place."""
        command = np.zeros(COMMAND)
        command[: len(duties)] = duties
        if self.file.moving_mass:
            command[MASS_PLACE:] = self.file.moving_mass.position.vector
        return command

    def check_step(self, step: float, model: VehicleModel | None = None) -> None:
        """Raise `BadInput` for a time step [s] too long for the model's fastest dynamics."""
        effect_parameters.check_step(self.file.name, self.collect_effects(), step)
        check_time_step(self.file.name, model or self.build_model(), step)

    @property
    def hull_height_on_floor(self) -> float:
        """Height of the hull centre when the vehicle stands on the floor. [m]."""
        foot = self.collect_effects().get('floor_contact')
        if foot is None:
            return mass_properties.half_axes(self.file.hull)[2]
        # The soft foot sinks in by weight over stiffness
        sink = self.heaviness * STANDARD_GRAVITY / foot['stiffness']
        return -foot['z'] - max(sink, 0.0)

    @property
    def hover_duty(self) -> float:
        """Duty of each vertical rotor that carries the heaviness. [1]."""
        return propulsion.hover_duty(
            self.file.name,
            self.rotors,
            self.file.aero.coupling,
            self.heaviness * STANDARD_GRAVITY,
            STANDARD_GRAVITY,
        )


def load_vehicle(name: str, air_density: float = AIR_DENSITY) -> Vehicle:
    """Return a vehicle by shipped name or path, in air of a density [kg/m3], or `BadInput`."""
    file = load_vehicle_file(name)
    try:
        return Vehicle(file, air_density)
    except BadInput as error:
        raise BadInput(f'{find_file("vehicle", name)}: {error}') from None


def parse_vehicle(text: str, where: str, air_density: float = AIR_DENSITY) -> Vehicle:
    """
    Return the vehicle of a file's text, or `BadInput`.

    Parameters
    ----------
    where : str
        The file, as the subject of an error message.

    """
    return Vehicle(validate_content(VehicleFile, parse_yaml(text, where), where), air_density)
