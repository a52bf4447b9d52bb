"""
A vehicle as the cores need it, derived from its file.

Mass, centre of gravity and inertia follow from the parts, the gas and the ballast that trims the
vehicle to its declared heaviness; added mass from the hull's shape (Lamb); everything about the
hull centre, body frame.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
import math
from typing import final

from lta_config.constants import AIR_DENSITY, STANDARD_GRAVITY
from lta_config.errors import BadInput
from lta_config.files import find
from lta_config.quantity import misfit, Quantity, UNSOURCED
from lta_config.vehicle_file import load_vehicle_file, Part, VehicleFile
from lta_energy.battery import Battery
from lta_energy.loads import Loads
from lta_energy.panel import Panel
from lta_sim import effects
from lta_sim.effects import rotational_drag
from lta_sim.effects.protocol import AXES
from lta_sim.mass import spheroid_added_mass
from lta_sim.model import Model
from lta_sim.sensors.photodiode import PhotodiodeArray
from lta_sim.state import ACTUATORS
import numpy as np
from numpy.typing import NDArray

ROTATION = tuple(known.name for known in rotational_drag.PARAMETERS)
HELIUM_TO_AIR = 0.1664 / AIR_DENSITY  # density ratio at one temperature and pressure (20 C, 1 atm)

Vector = tuple[float, ...]
Array = NDArray[np.float64]


@final
@dataclass(frozen=True, slots=True)
class Lump:
    """A mass with its centre and its inertia about that centre."""

    mass: float  # [kg]
    position: Array  # [m]
    inertia: Array  # diagonal about its own centre [kg m2]


def _lump(part: Part) -> Lump:
    """Return a part's mass properties: a box is solid, a shell thin and similar to itself."""
    mass = part.mass.si
    squares = np.square(part.size.vector)
    others = np.array([squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]])
    # Solid box 1/12 of full sizes; thin homothetic ellipsoid 1/3 of half axes.
    return Lump(mass, np.array(part.position.vector), mass * others / 12.0)


@final
class Vehicle:
    """
    One vehicle in air of a given density.

    Parameters
    ----------
    file : VehicleFile
        What the vehicle is.
    air_density : float
        Density of the air around it. [kg/m3]

    Raises
    ------
    BadInput
        If the parts are too heavy for the lift, the centre of gravity is above the hull centre,
        the rotors are not the number that the model has, or an effect is not known, has a
        parameter that it does not know, or one in the wrong unit or out of bounds.

    """

    def __init__(self, file: VehicleFile, air_density: float = AIR_DENSITY) -> None:
        self.file = file
        self.air_density = air_density
        if len(file.rotors) > ACTUATORS:
            raise BadInput(
                f'{file.name} has {len(file.rotors)} rotors; the model has room for {ACTUATORS}.'
            )
        if self.ballast < 0.0:
            raise BadInput(
                f'{file.name} is {-1e3 * self.ballast:.1f} g too heavy for its lift of '
                f'{1e3 * self.lift:.1f} g; make parts lighter or the hull larger.'
            )
        if self.cg[2] >= 0.0:
            raise BadInput(
                f'{file.name} has its centre of gravity {100 * self.cg[2]:.1f} cm above the hull '
                'centre and would flip; move mass down.'
            )
        self.model()  # refuses effects and parameters that do not exist or are out of bounds

    @property
    def volume(self) -> float:
        """Volume of the hull. [m3]."""
        hull = self.file.hull
        return hull.volume_factor.si * (0.5 * hull.diameter.si) ** 3

    @property
    def gas(self) -> float:
        """Mass of the gas, helium with the rest of the purity being air. [kg]."""
        purity = self.file.hull.purity.si
        return self.volume * self.air_density * (1.0 - purity * (1.0 - HELIUM_TO_AIR))

    @property
    def lift(self) -> float:
        """Gross lift: displaced air less gas. [kg]."""
        return self.volume * self.air_density - self.gas

    @property
    def ballast(self) -> float:
        """Mass that trims the parts to the declared heaviness. [kg]."""
        parts = sum(part.mass.si for part in self.file.parts.values())
        return self.lift + self.file.trim.heaviness.si - parts

    @cached_property
    def lumps(self) -> list[Lump]:
        """Everything that has mass: parts, ballast and gas."""
        hull = self.file.hull
        half = np.array([hull.diameter.si, hull.diameter.si, hull.height.si]) / 2.0
        squares = half**2
        gas = self.gas * np.array(
            [squares[1] + squares[2], squares[0] + squares[2], squares[0] + squares[1]]
        )
        ballast = np.array(self.file.trim.ballast_position.vector)
        return [
            *(_lump(part) for part in self.file.parts.values()),
            Lump(self.ballast, ballast, np.zeros(3)),
            Lump(self.gas, np.zeros(3), gas / 5.0),
        ]

    @property
    def mass(self) -> float:
        """Mass of everything, gas included. [kg]."""
        return sum(lump.mass for lump in self.lumps)

    @cached_property
    def cg(self) -> Array:
        """Centre of gravity, gas included, from the hull centre, shape (3,). [m]."""
        moment = np.sum([lump.mass * lump.position for lump in self.lumps], axis=0)
        return np.asarray(moment / self.mass)

    @property
    def inertia(self) -> Array:
        """Inertia about the centre of gravity, shape (3, 3). [kg m2]."""
        total = np.zeros((3, 3))
        for lump in self.lumps:
            r = lump.position - self.cg
            total += np.diag(lump.inertia)
            total += lump.mass * (float(r @ r) * np.eye(3) - np.outer(r, r))
        return total

    @property
    def added_mass(self) -> Vector:
        """Added mass and inertia of the hull as a spheroid (Lamb). [kg, kg m2]."""
        hull = self.file.hull
        return spheroid_added_mass(0.5 * hull.diameter.si, 0.5 * hull.height.si, self.air_density)

    @property
    def rotor_names(self) -> list[str]:
        """Actuator names in the order of `motors`."""
        return list(self.file.rotors)

    @cached_property
    def reversible(self) -> tuple[bool, ...]:
        """Whether each rotor accepts negative duty."""
        return tuple(rotor.reversible for rotor in self.file.rotors.values())

    @cached_property
    def thrust_curve(self) -> tuple[float, float]:
        """Coefficients a and b of T = a u^2 + b u. [N]."""
        return self.file.thrust_curve.a.si, self.file.thrust_curve.b.si

    @property
    def full_thrust(self) -> float:
        """Thrust of one rotor at full duty. [N]."""
        return sum(self.thrust_curve)

    @cached_property
    def allocation(self) -> tuple[Vector, ...]:
        """B as columns, one a rotor: wrench about the hull centre per newton. [1, m]."""
        columns = self.file.aero.thrust_allocation.values()
        return tuple((*column.force.vector, *column.moment.vector) for column in columns)

    @cached_property
    def diodes(self) -> PhotodiodeArray:
        """The ring of photodiodes."""
        ring = self.file.sensors.diodes
        return PhotodiodeArray(
            count=ring.count,
            depth=-ring.height.si,
            radius=ring.radius.si,
            feedback_resistance=ring.feedback.si,
        )

    @cached_property
    def battery(self) -> Battery:
        """The cell."""
        return Battery.of(self.file.energy)

    @cached_property
    def loads(self) -> Loads:
        """The consumers."""
        return Loads.of(self.file.energy)

    @cached_property
    def panel(self) -> Panel:
        """The solar panels."""
        return Panel.of(self.file.energy)

    def effects(self) -> dict[str, dict[str, float]]:
        """Return the parameters of every effect that is on, in SI."""
        aero = self.file.aero
        linear, quadratic = aero.linear_drag, aero.quadratic_drag
        a, b = self.thrust_curve
        numbers = range(1, len(self.file.rotors) + 1)
        columns = zip(numbers, self.allocation, strict=True)
        added = self.added_mass
        derived = {
            'weight_and_buoyancy': {'gravity': STANDARD_GRAVITY},
            'added_mass': dict(zip(AXES[:3], added[:3], strict=True)),
            'added_inertia': dict(zip(AXES[3:], added[3:], strict=True)),
            'linear_drag': dict(zip(AXES[:3], linear.force.vector, strict=True)),
            'quadratic_drag': dict(zip(AXES[:3], quadratic.force.vector, strict=True)),
            'rotational_drag': dict(
                zip(ROTATION, linear.moment.vector + quadratic.moment.vector, strict=True)
            ),
            'thrust_curve': {f'{n}_{i}': x for n, x in (('a', a), ('b', b)) for i in numbers},
            'rotor_thrust': {
                f'{axis}_{i}': x
                for i, column in columns
                for axis, x in zip(AXES, column, strict=True)
            },
        }
        for name in self.file.effects:
            if name in derived:
                raise BadInput(
                    f'The effect {name} of {self.file.name} follows from hull, parts, rotors or '
                    'aero; change it there.'
                )
        return derived | {name: _checked(name, given) for name, given in self.file.effects.items()}

    @property
    def _axes(self) -> list[Array]:
        """Direction in which each rotor pushes."""
        forces = [np.array(column[:3]) for column in self.allocation]
        return [force / np.linalg.norm(force) for force in forces]

    def model(self) -> Model:
        """Return the numbers that the kernel takes."""
        places = (rotor.position.vector for rotor in self.file.rotors.values())
        return Model.build(
            self.effects(),
            mass=self.mass,
            cg=self.cg,
            inertia=self.inertia,
            displaced=self.volume * self.air_density,
            rotors=list(zip(places, self._axes, strict=True)),
        )

    @property
    def standing_height(self) -> float:
        """Height of the hull centre when the vehicle stands on the floor. [m]."""
        foot = self.effects().get('floor_contact')
        if foot is None:
            return 0.5 * self.file.hull.height.si
        sink = self.file.trim.heaviness.si * STANDARD_GRAVITY / foot['stiffness']
        return -foot['z'] - max(sink, 0.0)

    @property
    def hover_duty(self) -> float:
        """Duty of each vertical rotor that carries the heaviness. [1]."""
        a, b = self.thrust_curve
        up = [column[2] for column in self.allocation if column[2] > 0.5]
        if not up:
            raise BadInput(f'{self.file.name} has no rotor that lifts; it cannot hover.')
        thrust = self.file.trim.heaviness.si * STANDARD_GRAVITY / sum(up)
        if thrust > self.full_thrust:
            raise BadInput(
                f'{self.file.name} needs {thrust:.3f} N of each lifting rotor to hover, but they '
                f'give {self.full_thrust:.3f} N; take off '
                f'{1e3 * (thrust - self.full_thrust) * sum(up) / STANDARD_GRAVITY:.1f} g.'
            )
        return 2.0 * thrust / (b + math.sqrt(b * b + 4.0 * a * thrust)) if thrust > 0 else 0.0


def _checked(name: str, given: Mapping[str, Quantity]) -> dict[str, float]:
    """Return an effect's parameters in SI, each in the unit that the effect declares."""
    declared = {parameter.name: parameter for parameter in effects.get(name).parameters}
    for key, quantity in given.items():
        wrong = None if quantity.source else UNSOURCED
        if (known := declared.get(key)) is not None:  # else the model refuses it
            ends = () if quantity.vector == (known.null,) else (known.low, known.high)
            wrong = misfit(quantity, known.unit, *ends) or wrong
        if wrong:
            raise BadInput(f'effects.{name}.{key} {wrong}.')
    return {key: quantity.si for key, quantity in given.items()}


def load_vehicle(name: str, air_density: float = AIR_DENSITY) -> Vehicle:
    """Return a vehicle by shipped name or path; anything wrong is a `BadInput` sentence."""
    file = load_vehicle_file(name)
    try:
        return Vehicle(file, air_density)
    except BadInput as error:
        raise BadInput(f'{find("vehicle", name)}: {error}') from None
