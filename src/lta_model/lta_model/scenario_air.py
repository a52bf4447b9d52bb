# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Compute turbulence intensity and length near the ground by MIL-F-8785C, for scenarios.

    sigma_w = 0.1 U_20,    sigma_u = sigma_v = sigma_w / (0.177 + 0.000823 h)^0.4
    L_w = h,               L_u = L_v = h / (0.177 + 0.000823 h)^1.2

with h in feet, from 10 ft to 1000 ft (MIL-F-8785C, section 3.7.3.4), U_20 the mean wind at 20 ft:
15, 30 and 45 knots there for light, moderate and severe. Continued to the height at which a small
blimp flies, 0.5 m, it would say that the wind there has 1.4 m/s rms when 8 m/s blow at 10 m, more
than the wind itself: below 10 ft it is refused. `sheared_turbulence` continues it with the mean
wind of a profile: at 10 ft it has the values of the standard, and below, rms by mean wind and
length by height stay the same (effect `turbulence`).

The air section of a scenario file, and the effects that follow from it.

Uniform wind (`wind`) and recorded wind (`recorded`) are surroundings of the kernel; the rest are
air effects. All winds add up, as the direction of the flow in `map`.
"""

from collections.abc import Callable
import math
from typing import Annotated, Literal, Self

from lta_config.errors import BadInput
from lta_config.files import StrictModel
from lta_config.quantity import describe_misfit, Quantity, si_quantity
from pydantic import AfterValidator, Field, model_validator

# m
METRES_PER_FOOT = 0.3048
LOWEST_STANDARD, HIGHEST_STANDARD = 10.0 * METRES_PER_FOOT, 1000.0 * METRES_PER_FOOT
WIND_HEIGHT = 20.0 * METRES_PER_FOOT  # height of the mean wind


def low_altitude_turbulence(height: float, wind: float) -> dict[str, float]:
    """
    Return the parameters of the effect `turbulence`: intensities [m/s] and lengths [m].

    From the height above the ground, 3.05 to 305 m, and the mean wind at 20 ft (6.1 m) [m/s].

    Raise `BadInput` if the height is out of range, or the wind is negative.
    """
    if not LOWEST_STANDARD <= height <= HIGHEST_STANDARD:
        raise BadInput(
            f'MIL-F-8785C defines no low-altitude turbulence at a height of {height:g} m, '
            f'only from {LOWEST_STANDARD:.2f} to {HIGHEST_STANDARD:.0f} m; under '
            'air.turbulence in the scenario, give intensity and length instead of "by", '
            '"wind" and "height".'
        )
    if not wind >= 0.0:
        raise BadInput(f'The mean wind speed at 20 ft is {wind:g} m/s; it must be 0 or more.')
    # The specification has the height in feet
    factor = 0.177 + 0.000823 * height / METRES_PER_FOOT
    up, level = 0.1 * wind, 0.1 * wind / factor**0.4
    length = height / factor**1.2
    return {
        'along': level,
        'across': level,
        'up': up,
        'along_length': length,
        'across_length': length,
        'up_length': height,
    }


def sheared_turbulence(mean_wind: Callable[[float], float]) -> dict[str, float]:
    """Return parameters that follow the height, from the mean wind [m/s] by height [m]."""
    turbulence = low_altitude_turbulence(LOWEST_STANDARD, mean_wind(WIND_HEIGHT))
    return turbulence | {'mean': mean_wind(LOWEST_STANDARD), 'height': LOWEST_STANDARD}


GAS_CONSTANT_OF_AIR = 287.05  # J/(kg K), dry
WIND_AXES = ('along', 'across', 'up')
Parameters = dict[str, float]


def _axes_validator(dimension: str, low: float, high: float) -> AfterValidator:
    """Return the check of a quantity for all axes alike, or one for each."""

    def check(quantity: Quantity) -> Quantity:
        count = len(quantity.vector)
        if complaint := describe_misfit(
            quantity, dimension, low, high, length=3 if count > 1 else 1
        ):
            raise ValueError(complaint)
        return quantity

    return AfterValidator(check)


Speed = Annotated[Quantity, si_quantity('m/s', low=0.0, high=60.0)]
Wind = Annotated[Quantity, si_quantity('m/s', low=-60.0, high=60.0, length=3)]
Slope = Annotated[Quantity, si_quantity('1/s', low=-10.0, high=10.0, length=3)]


class WindProfile(StrictModel):
    """
    Wind over rough ground: measured wind at a height, and the roughness length.

    `towards` is the direction of the flow, anticlockwise from map x.
    """

    wind: Speed
    towards: Annotated[Quantity, si_quantity('rad')]
    height: Annotated[Quantity, si_quantity('m', low=0.1, high=300.0)] = Quantity(
        value=10.0, unit='m'
    )
    roughness: Annotated[Quantity, si_quantity('m', low=1e-5, high=5.0)]

    @model_validator(mode='after')
    def _check_heights(self) -> Self:
        if self.height.si <= self.roughness.si:
            raise ValueError(
                f'has its wind at a height of {self.height.si:g} m, which is not above the '
                f'roughness length of {self.roughness.si:g} m; give the wind speed at a '
                'greater height'
            )
        return self

    def mean_wind(self, height: float) -> float:
        """Return the mean wind at a height [m] by the log law [m/s]."""
        rough = self.roughness.si
        return self.wind.si * max(math.log(height / rough), 0.0) / math.log(self.height.si / rough)

    def effect_parameters(self, half_height: float) -> Parameters:
        """Return the parameters of `wind_profile` for half the height of a hull [m]."""
        speed, towards = self.wind.si, self.towards.si
        return {
            'x': speed * math.cos(towards),
            'y': speed * math.sin(towards),
            'height': self.height.si,
            'roughness': self.roughness.si,
            'half_height': half_height,
        }


class Turbulence(StrictModel):
    """
    Dryden turbulence: rms and length along the mean wind, across it and up, or one for all three.

    Or `by` a standard, which derives both from the mean wind at 6.1 m (20 ft) and the height. If
    it is `sheared`, wind and height are those of the scene and of the hull. `strength` multiplies
    the rms; at 0 there is no turbulence.
    """

    intensity: Annotated[Quantity, _axes_validator('m/s', 0.0, 30.0)] | None = None
    length: Annotated[Quantity, _axes_validator('m', 0.1, 1000.0)] | None = None
    by: Literal['MIL-F-8785C'] | None = None
    wind: Speed | None = None
    height: Annotated[Quantity, si_quantity('m')] | None = None
    sheared: bool = False
    strength: Annotated[Quantity, si_quantity('1', low=0.0, high=10.0)] = Quantity(
        value=1.0, unit='1'
    )

    @model_validator(mode='after')
    def _check_exclusive_forms(self) -> Self:
        own, standard = (self.intensity, self.length), (self.by, self.wind, self.height)
        if self.sheared:
            self._check_sheared()
            return self
        if None not in own and standard == (None,) * 3:
            return self
        if None not in standard and own == (None,) * 2:
            # Raises for a height that the standard does not cover
            self.effect_parameters()
            return self
        raise ValueError(
            'needs either intensity and length, or "by: MIL-F-8785C" with wind (mean wind '
            'speed at 20 ft) and height (flight height)'
        )

    def _check_sheared(self) -> None:
        """Raise ValueError unless `by` is given, and nothing that it derives."""
        own = ('intensity', 'length', 'wind', 'height')
        present = [name for name in own if getattr(self, name) is not None]
        remedies = [
            *(['add "by: MIL-F-8785C"'] if self.by is None else []),
            *([f'remove {", ".join(present)}'] if present else []),
        ]
        if remedies:
            raise ValueError(
                'follows the height ("sheared"), by "by: MIL-F-8785C" and the wind of the scene; '
                + ' and '.join(remedies)
            )

    def effect_parameters(self, mean_wind: Callable[[float], float] | None = None) -> Parameters:
        """Return the parameters of `turbulence`; sheared, from the mean wind by height."""
        parameters = self._full_parameters(mean_wind)
        return parameters | {axis: self.strength.si * parameters[axis] for axis in WIND_AXES}

    def _full_parameters(self, mean_wind: Callable[[float], float] | None) -> Parameters:
        """Return the parameters at a strength of 1."""
        if self.sheared and mean_wind is not None:
            return sheared_turbulence(mean_wind)
        if self.wind is not None and self.height is not None:
            return low_altitude_turbulence(self.height.si, self.wind.si)
        strong, long = (
            # One value stands for all three axes
            quantity.vector * 3 if len(quantity.vector) == 1 else quantity.vector
            for quantity in (self.intensity, self.length)
            if quantity is not None
        )
        return dict(zip(WIND_AXES, strong, strict=True)) | {
            f'{axis}_length': length for axis, length in zip(WIND_AXES, long, strict=True)
        }


class Gust(StrictModel):
    """One gust: it begins, takes `length` to build up, lasts for `hold` and decays as it rose."""

    wind: Wind
    begin: Annotated[Quantity, si_quantity('s', low=0.0, high=1e5)]
    length: Annotated[Quantity, si_quantity('s', low=0.01, high=1e4)]
    hold: Annotated[Quantity, si_quantity('s', low=0.0, high=1e6)] = Quantity(value=0.0, unit='s')

    def effect_parameters(self) -> Parameters:
        """Return the parameters of `gusts`."""
        return dict(zip('xyz', self.wind.vector, strict=True)) | {
            'begin': self.begin.si,
            'length': self.length.si,
            'hold': self.hold.si,
        }


class WindGradient(StrictModel):
    """
    A wind that varies in space, and is zero at `origin`.

    `x` is the change of the wind along map x with map x, y and z; `y` and `z` likewise. The air
    is incompressible, so the last element of `z` follows from the others.
    """

    origin: Annotated[Quantity, si_quantity('m', low=-1000.0, high=1000.0, length=3)]
    x: Slope
    y: Slope
    z: Annotated[Quantity, si_quantity('1/s', low=-10.0, high=10.0, length=2)]

    def effect_parameters(self) -> Parameters:
        """Return the parameters of `wind_gradient`."""
        rows = (('x', self.x), ('y', self.y), ('z', self.z))
        return dict(zip('xyz', self.origin.vector, strict=True)) | {
            f'{name}_{axis}': slope
            for name, row in rows
            for axis, slope in zip('xyz', row.vector, strict=False)
        }


class ScenarioAir(StrictModel):
    """State and motion of the air."""

    temperature: Annotated[Quantity, si_quantity('degC', low=-40.0, high=60.0)]
    pressure: Annotated[Quantity, si_quantity('Pa', low=5e4, high=1.2e5)]
    wind: Annotated[
        Quantity, si_quantity('m/s', low=-50.0, high=50.0, length=3)
    ]  # uniform and steady
    profile: WindProfile | None = None
    turbulence: Turbulence | None = None
    gust: Gust | None = None
    gradient: WindGradient | None = None
    recorded: Annotated[str, Field(pattern=r'\.csv$')] | None = None  # of `wind_record`

    @model_validator(mode='after')
    def _check_roughness(self) -> Self:
        rough = 0.0 if self.profile is None else self.profile.roughness.si
        lowest, eddies = LOWEST_STANDARD, self.turbulence
        if eddies and eddies.sheared and eddies.strength.si > 0.0 and rough >= lowest:
            raise ValueError(
                f'has sheared turbulence over a roughness length of {rough:g} m, but the mean '
                f'wind that it follows starts above {lowest:.2f} m (10 ft); reduce '
                'profile.roughness, or give turbulence.intensity and length instead'
            )
        return self

    @property
    def density(self) -> float:
        """Density of dry air. [kg/m3]."""
        # Ideal gas law, absolute temperature
        return self.pressure.si / (GAS_CONSTANT_OF_AIR * (self.temperature.si + 273.15))

    def mean_wind(self, height: float) -> float:
        """Return the speed of uniform wind and profile together at a height [m] [m/s]."""
        x, y, _ = self.wind.vector
        if self.profile is not None:
            speed, towards = self.profile.mean_wind(height), self.profile.towards.si
            x, y = x + speed * math.cos(towards), y + speed * math.sin(towards)
        return math.hypot(x, y)

    def collect_effects(self, half_height: float) -> dict[str, Parameters]:
        """Return the air effects that are on, by name, in SI; `half_height` of the hull in m."""
        effects = {}
        if self.profile:
            effects['wind_profile'] = self.profile.effect_parameters(half_height)
        if self.gradient:
            effects['wind_gradient'] = self.gradient.effect_parameters()
        if self.turbulence and self.turbulence.strength.si > 0.0:
            effects['turbulence'] = self.turbulence.effect_parameters(self.mean_wind)
        if self.gust:
            effects['gusts'] = self.gust.effect_parameters()
        return effects
