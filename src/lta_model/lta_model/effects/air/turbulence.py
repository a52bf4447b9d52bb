"""
Dryden turbulence: white noise through filters with the spectra of the atmosphere.

    along       H(s) = sigma sqrt(2 T) / (1 + T s)
    across, up  H(s) = sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2
    T = L / max(V, sigma)

from white noise of unit intensity, with L as in MIL-F-8785C, section 3.7.1 (MIL-HDBK-1797 halves
the lengths across and up for the same spectrum). V is the speed relative to the mean wind, the sum
of the winds before this effect. A vehicle at V passes eddies of length L in L / V. A drifting one
stays in its eddy, which turns over in about L / sigma; max() takes the shorter, so the spectrum is
defined at rest. Across is horizontal; along is the horizontal direction of the mean wind, or map x
in still air.

The noise comes from the surroundings and is constant during a control period d, which leaves the
variance tanh(d / 2T) 2T / d, 1 - (d / T)^2 / 12, of sigma^2. The memory is in units of sigma. From
its initial zeros the turbulence becomes stationary after a few T; `stationary_memory` draws a
stationary state: variance 1 along, 1/2 and 1/4 across and up, covariance 1/4 of these two states.

Near the ground both follow the height, by two optional references that stand for the place at
which sigma and L hold:

    sigma(z) = sigma min(V_mean(z) / mean, 1),    L(z) = L min(z / height, 1)

V_mean is the mean wind at the hull, such as that of `wind_profile`, z its height. L ~ z as in
MIL-F-8785C (L_w = h, the others within 6 % below 10 ft); among the elements of the roughness the
intensity sigma / V_mean stays about the same (Finnigan 2000, Annu. Rev. Fluid Mech. 32, from
memory). Without a reference, rms or length is the same everywhere.

    DU/Dt = 0

The eddies are frozen: air that moves with the mean wind keeps its velocity. They act by drag and
by the relative velocity of the added mass. Not modelled: the pressure gradient within an eddy, of
order sigma^2 / L, and gradients over the hull, which would rock it; use L well above the hull.
"""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import AirEffect, AirEffectInput, EffectParameter, Values, Wrench
from lta_model.state import NOISE

_WIND = 'spread: 10 % of a wind of 1 m/s, as the vertical part in MIL-F-8785C; limit: a storm'
_LENGTH = 'MIL-F-8785C: up to 533 m, near the ground about the height; spread: 0.5 m (assumed)'

PARAMETERS = (
    *(
        EffectParameter(name, 'm/s', 0.0, 0.0, 30.0, 0.1, _WIND)
        for name in ('along', 'across', 'up')
    ),
    *(
        EffectParameter(f'{name}_length', 'm', 0.0, 0.1, 1e3, 0.5, _LENGTH)
        for name in ('along', 'across', 'up')
    ),
    EffectParameter(
        'mean', 'm/s', 0.0, 0.0, 60.0, 0.5, 'spread: as of a steady wind; limit: a storm'
    ),
    EffectParameter(
        'height', 'm', 0.0, 0.0, 300.0, 0.5, 'MIL-F-8785C: 10 to 1000 ft; spread: 0.5 m (assumed)'
    ),
)

MEMORY = (('along', 0.0), ('across_1', 0.0), ('across_2', 0.0), ('up_1', 0.0), ('up_2', 0.0))

# Zero of the transverse Dryden filter
ROOT_3 = math.sqrt(3.0)
SHORTEST = 0.05  # share of the length below which no height reduces it
STILL_AIR = 1e-6  # square of the mean wind below which it has no direction [m2/s2]


def shear_shares(mean: float, height: float, place: AirEffectInput) -> tuple[float, float]:
    """Return rms and length at the hull, relative to those of the parameters. [1]"""
    wind = place.wind
    speed = math.sqrt(wind[0] * wind[0] + wind[1] * wind[1])
    strong = min(speed / mean, 1.0) if mean > 0.0 else 1.0
    # No eddy has a length of zero, wherever the hull is
    long = min(max(place.position[2] / height, SHORTEST), 1.0) if height > 0.0 else 1.0
    return strong, long


def compute_air_motion(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """Return the turbulence from the state of the filters."""
    along, across, up, along_length, across_length, up_length, mean, height = p  # noqa: RUF059
    strong = shear_shares(mean, height, place)[0]
    along, across, up = strong * along, strong * across, strong * up
    head = along * memory[0]
    # (1 + sqrt(3) T s) / (1 + T s)^2 as two poles in series, states 1 and 2
    side = across * (ROOT_3 * memory[1] + (1.0 - ROOT_3) * memory[2])
    w = up * (ROOT_3 * memory[3] + (1.0 - ROOT_3) * memory[4])
    east, north = place.wind[0], place.wind[1]
    square = east * east + north * north
    # Without a mean wind, along is map x
    if square <= STILL_AIR:
        return (head, side, w, 0.0, 0.0, 0.0)
    scale = 1.0 / math.sqrt(square)
    c, s = east * scale, north * scale
    # From along/across to map x and y; the vertical stays
    return (c * head - s * side, s * head + c * side, w, 0.0, 0.0, 0.0)


def inverse_time_constant(sigma: float, length: float, speed: float) -> float:
    """Return 1 / T. [1/s]"""
    return max(speed, sigma) / length if length > 0.0 else 0.0


def compute_memory_rate(p: Values, memory: Values, place: AirEffectInput) -> Values:
    """Return d/dt of the filters."""
    along, across, up, along_length, across_length, up_length, mean, height = p
    strong, long = shear_shares(mean, height, place)
    # Speed of the hull relative to the mean wind sets how fast eddies pass
    u = place.velocity[0] - place.wind[0]
    v = place.velocity[1] - place.wind[1]
    w = place.velocity[2] - place.wind[2]
    speed = math.sqrt(u * u + v * v + w * w)
    a, b, c = (
        inverse_time_constant(strong * along, long * along_length, speed),
        inverse_time_constant(strong * across, long * across_length, speed),
        inverse_time_constant(strong * up, long * up_length, speed),
    )
    noise = place.surroundings
    return (
        # Unit-intensity noise through one pole: stationary variance 1
        math.sqrt(2.0 * a) * noise[NOISE] - a * memory[0],
        # Stationary variance 1/2 of the first pole, 1/4 of the second
        math.sqrt(b) * noise[NOISE + 1] - b * memory[1],
        b * (memory[1] - memory[2]),
        math.sqrt(c) * noise[NOISE + 2] - c * memory[3],
        c * (memory[3] - memory[4]),
    )


def stationary_memory(normals: Values) -> Values:
    """Return a memory of stationary turbulence, from five standard normal numbers."""
    head, side, sideways, rise, rising = normals
    # Cholesky factor of the covariance ((1/2, 1/4), (1/4, 1/4))
    side, rise = side * math.sqrt(0.5), rise * math.sqrt(0.5)
    rest = math.sqrt(0.125)  # standard deviation of the second state, given the first
    return (head, side, 0.5 * side + rest * sideways, rise, 0.5 * rise + rest * rising)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to turbulence without a length."""
    for name in ('along', 'across', 'up'):
        if values[name] > 0.0 and values[f'{name}_length'] <= 0.0:
            return (
                f'turbulence of the component {name} needs a length scale; set {name}_length, '
                'in metres'
            )
    return ''


EFFECT = AirEffect(
    'turbulence', PARAMETERS, compute_air_motion, MEMORY, compute_memory_rate, find_conflict
)
