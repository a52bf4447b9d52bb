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
"""

from collections.abc import Callable

from lta_config.errors import BadInput

# m
FOOT = 0.3048
LOWEST, HIGHEST = 10.0 * FOOT, 1000.0 * FOOT
MEASURED = 20.0 * FOOT  # height of the mean wind


def low_altitude_turbulence(height: float, wind: float) -> dict[str, float]:
    """
    Return the parameters of the effect `turbulence`: intensities [m/s] and lengths [m].

    From the height above the ground, 3.05 to 305 m, and the mean wind at 20 ft (6.1 m) [m/s].

    Raise `BadInput` if the height is out of range, or the wind is negative.
    """
    if not LOWEST <= height <= HIGHEST:
        raise BadInput(
            f'MIL-F-8785C defines no low-altitude turbulence at a height of {height:g} m, '
            f'only from {LOWEST:.2f} to {HIGHEST:.0f} m; under air.turbulence in the scenario, '
            'give intensity and length instead of "by", "wind" and "height".'
        )
    if not wind >= 0.0:
        raise BadInput(f'The mean wind speed at 20 ft is {wind:g} m/s; it must be 0 or more.')
    # The specification has the height in feet
    factor = 0.177 + 0.000823 * height / FOOT
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
    turbulence = low_altitude_turbulence(LOWEST, mean_wind(MEASURED))
    return turbulence | {'mean': mean_wind(LOWEST), 'height': LOWEST}
