# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Wind, gusts and turbulence at the hull."""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import (
    AirEffect,
    AirEffectInput,
    declare_each,
    EffectParameter,
    Values,
    Wrench,
)
from lta_model.state import NOISE


def steady_wind(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """
    Uniform steady wind.

        U = (x, y, z),    DU/Dt = 0

    in `map`, as the direction of the flow (not where the wind comes from).
    """
    x, y, z = p
    return (x, y, z, 0.0, 0.0, 0.0)


_STEADY_WIND_SOURCE = 'spread: an indoor draught (assumed); limits: stronger than any storm'

STEADY_WIND = AirEffect(
    'steady_wind',
    declare_each(('x', 'y', 'z'), 'm/s', 0.0, -60.0, 60.0, 0.1, _STEADY_WIND_SOURCE),
    steady_wind,
)


def wind_profile(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """
    Logarithmic wind profile over rough ground, averaged over the height of the hull.

        U(z) = U_ref ln(z / z_0) / ln(h_ref / z_0)   for z > z_0,   else 0
        mean over z - h .. z + h = U_ref (F(z + h) - F(z - h)) / (2 h ln(h_ref / z_0))
        F(z) = z (ln(z / z_0) - 1) + z_0             for z > z_0,   else 0
        DU/Dt = W d/dz (mean U)

    U_ref = (x, y) is the wind at the reference height in `map`, as the direction of the flow; z_0
    is the roughness length, h half the height of the hull, W the vertical wind of the effects
    before this one. F is the integral of the profile with a continuous slope, so the wind on the
    hull is smooth and finite down to the floor. h = 0 gives the profile itself.

    Log law of the neutral surface layer (Prandtl; WMO-No. 8 takes the wind at 10 m). Among the
    roughness elements it is only an approximation: at 0.5 m over z_0 = 0.3 m, try other z_0 as
    well. Not modelled: displacement height, stability, weighting of slices by their width.
    """
    x, y, height, roughness, half_height = p
    # Effect off, or a profile without a positive logarithm
    if roughness <= 0.0 or height <= roughness:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    top, bottom = place.position[2] + half_height, place.position[2] - half_height
    # The whole hull is below the roughness length, where the wind is zero
    if top <= roughness:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Logarithms at the upper and the lower end of the hull
    high = math.log(top / roughness)
    low = math.log(bottom / roughness) if bottom > roughness else 0.0
    if half_height > 0.0:
        # F(z + h), then less F(z - h), over 2 h
        share = top * (high - 1.0) + roughness
        share -= bottom * (low - 1.0) + roughness if bottom > roughness else 0.0
        share *= 0.5 / half_height
        slope = 0.5 * (high - low) / half_height
    else:
        # Limit h -> 0: the profile itself and its slope
        share, slope = high, 1.0 / top
    scale = 1.0 / math.log(height / roughness)
    # A vertical wind carries the hull through the profile: DU/Dt = W dU/dz
    share, slope = share * scale, slope * scale * place.wind[2]
    return (x * share, y * share, 0.0, x * slope, y * slope, 0.0)


def check_wind_profile(values: Mapping[str, float]) -> str:
    """Return an objection to a reference wind without rough ground."""
    if values['x'] == 0.0 and values['y'] == 0.0:
        return ''
    if values['roughness'] <= 0.0:
        return 'a wind profile needs the roughness length of the ground; set roughness, in metres'
    if values['height'] <= values['roughness']:
        return 'height (the reference height) must be larger than roughness (the roughness length)'
    return ''


_WIND_PROFILE_WIND = (
    'spread: 0.5 m/s, the error of a hand anemometer (assumed); limits: stronger than any storm'
)
_WIND_HEIGHT = 'WMO-No. 8: 10 m (unverified, from memory); spread: 1 m (assumed)'
_ROUGHNESS = (
    'limits: 0.01 mm (ice) and 5 m (city), unverified, from memory; spread: a third of 0.3 m'
)
_HALF_HULL = 'half the height of the hull, from its shape; spread: 1 cm'

WIND_PROFILE = AirEffect(
    'wind_profile',
    (
        *declare_each(('x', 'y'), 'm/s', 0.0, -60.0, 60.0, 0.5, _WIND_PROFILE_WIND),
        EffectParameter('height', 'm', 10.0, 0.1, 300.0, 1.0, _WIND_HEIGHT),
        EffectParameter('roughness', 'm', 0.0, 1e-5, 5.0, 0.1, _ROUGHNESS),
        EffectParameter('half_height', 'm', 0.0, 0.01, 10.0, 0.01, _HALF_HULL),
    ),
    wind_profile,
    check=check_wind_profile,
)


def wind_gradient(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """
    Steady wind with a constant spatial gradient.

        U = G (r - r_0),    DU/Dt = G (U_before + U),    G_zz = -(G_xx + G_yy)

    in `map`; G_ij is d U_i / d r_j and `x_y` its element for i = x, j = y. The air is
    incompressible, so the last element follows from the others. U_before is the wind of the
    surroundings and of the effects before this one: put a uniform part into `steady_wind`. The
    wind of later effects does not contribute to DU/Dt.

    An antisymmetric G is a rigid rotation with a pressure gradient towards its axis, as in an
    eddy. The force on a hull small against the scale of G is that of Auton, Hunt and Prud'homme
    1988 (J. Fluid Mech. 197, doi 10.1017/S0022112088003246). Not modelled: the moment of a strain
    on a long hull, and the lift of vorticity.
    """
    x, y, z, x_x, x_y, x_z, y_x, y_y, y_z, z_x, z_y = p
    # Incompressible air: the trace of G is zero
    z_z = -(x_x + y_y)
    east, north, up = place.position[0] - x, place.position[1] - y, place.position[2] - z
    u = x_x * east + x_y * north + x_z * up
    v = y_x * east + y_y * north + y_z * up
    w = z_x * east + z_y * north + z_z * up
    # DU/Dt = G times the total velocity of the air, which carries it through the gradient
    a, b, c = u + place.wind[0], v + place.wind[1], w + place.wind[2]
    return (
        u,
        v,
        w,
        x_x * a + x_y * b + x_z * c,
        y_x * a + y_y * b + y_z * c,
        z_x * a + z_y * b + z_z * c,
    )


_WIND_GRADIENT_SOURCE = (
    'spread: 0.05 m/s over a metre, an indoor draught; limits: that in a vortex ring '
    '(both assumed)'
)
_HALL_PLACE = 'spread: 1 m (assumed); limits: a large hall'

WIND_GRADIENT = AirEffect(
    'wind_gradient',
    (
        *declare_each(('x', 'y', 'z'), 'm', 0.0, -1e3, 1e3, 1.0, _HALL_PLACE),
        *declare_each(
            ('x_x', 'x_y', 'x_z', 'y_x', 'y_y', 'y_z', 'z_x', 'z_y'),
            '1/s',
            0.0,
            -10.0,
            10.0,
            0.05,
            _WIND_GRADIENT_SOURCE,
        ),
    ),
    wind_gradient,
)


# Zero of the transverse Dryden filter
ROOT_3 = math.sqrt(3.0)
LEAST_LENGTH_SHARE = 0.05  # share of the length below which no height reduces it
STILL_AIR = 1e-6  # square of the mean wind below which it has no direction [m2/s2]


def turbulence(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """
    Dryden turbulence: white noise through filters with the spectra of the atmosphere.

        along       H(s) = sigma sqrt(2 T) / (1 + T s)
        across, up  H(s) = sigma sqrt(T) (1 + sqrt(3) T s) / (1 + T s)^2
        T = L / max(V, sigma)

    from white noise of unit intensity, with L as in MIL-F-8785C, section 3.7.1 (MIL-HDBK-1797
    halves the lengths across and up for the same spectrum). V is the speed relative to the mean
    wind, the sum of the winds before this effect. A vehicle at V passes eddies of length L in
    L / V. A drifting one stays in its eddy, which turns over in about L / sigma; max() takes the
    shorter, so the spectrum is defined at rest. Across is horizontal; along is the horizontal
    direction of the mean wind, or map x in still air.

    The noise comes from the surroundings and is constant during a control period d, which leaves
    the variance tanh(d / 2T) 2T / d, 1 - (d / T)^2 / 12, of sigma^2. The memory is in units of
    sigma. From its initial zeros the turbulence becomes stationary after a few T;
    `stationary_memory` draws a stationary state: variance 1 along, 1/2 and 1/4 across and up,
    covariance 1/4 of these two states.

    Near the ground both follow the height, by two optional references that stand for the place at
    which sigma and L hold:

        sigma(z) = sigma min(V_mean(z) / mean, 1),    L(z) = L min(z / height, 1)

    V_mean is the mean wind at the hull, such as that of `wind_profile`, z its height. L ~ z as in
    MIL-F-8785C (L_w = h, the others within 6 % below 10 ft); among the elements of the roughness
    the intensity sigma / V_mean stays about the same (Finnigan 2000, Annu. Rev. Fluid Mech. 32,
    from memory). Without a reference, rms or length is the same everywhere.

        DU/Dt = 0

    The eddies are frozen: air that moves with the mean wind keeps its velocity. They act by drag
    and by the relative velocity of the added mass. Not modelled: the pressure gradient within an
    eddy, of order sigma^2 / L, and gradients over the hull, which would rock it; use L well above
    the hull.
    """
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


def shear_shares(mean: float, height: float, place: AirEffectInput) -> tuple[float, float]:
    """Return rms and length at the hull, relative to those of the parameters [1]."""
    wind = place.wind
    speed = math.sqrt(wind[0] * wind[0] + wind[1] * wind[1])
    strong = min(speed / mean, 1.0) if mean > 0.0 else 1.0
    # No eddy has a length of zero, wherever the hull is
    long = min(max(place.position[2] / height, LEAST_LENGTH_SHARE), 1.0) if height > 0.0 else 1.0
    return strong, long


def inverse_time_constant(sigma: float, length: float, speed: float) -> float:
    """Return 1 / T [1/s]."""
    return max(speed, sigma) / length if length > 0.0 else 0.0


def stationary_memory(normals: Values) -> Values:
    """Return a memory of stationary turbulence, from five standard normal numbers."""
    head, side, sideways, rise, rising = normals
    # Cholesky factor of the covariance ((1/2, 1/4), (1/4, 1/4))
    side, rise = side * math.sqrt(0.5), rise * math.sqrt(0.5)
    rest = math.sqrt(0.125)  # standard deviation of the second state, given the first
    return (head, side, 0.5 * side + rest * sideways, rise, 0.5 * rise + rest * rising)


def turbulence_rate(p: Values, memory: Values, place: AirEffectInput) -> Values:
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


def check_turbulence(values: Mapping[str, float]) -> str:
    """Return an objection to turbulence without a length."""
    for name in ('along', 'across', 'up'):
        if values[name] > 0.0 and values[f'{name}_length'] <= 0.0:
            return (
                f'turbulence of the component {name} needs a length scale; set {name}_length, '
                'in metres'
            )
    return ''


_TURBULENCE_WIND = (
    'spread: 10 % of a wind of 1 m/s, as the vertical part in MIL-F-8785C; limit: a storm'
)
_LENGTH = 'MIL-F-8785C: up to 533 m, near the ground about the height; spread: 0.5 m (assumed)'
_TURBULENCE_HEIGHT = 'MIL-F-8785C: 10 to 1000 ft; spread: 0.5 m (assumed)'

TURBULENCE = AirEffect(
    'turbulence',
    (
        *declare_each(('along', 'across', 'up'), 'm/s', 0.0, 0.0, 30.0, 0.1, _TURBULENCE_WIND),
        *(
            EffectParameter(f'{name}_length', 'm', 0.0, 0.1, 1e3, 0.5, _LENGTH)
            for name in ('along', 'across', 'up')
        ),
        EffectParameter(
            'mean', 'm/s', 0.0, 0.0, 60.0, 0.5, 'spread: as of a steady wind; limit: a storm'
        ),
        EffectParameter('height', 'm', 0.0, 0.0, 300.0, 0.5, _TURBULENCE_HEIGHT),
    ),
    turbulence,
    (('along', 0.0), ('across_1', 0.0), ('across_2', 0.0), ('up_1', 0.0), ('up_2', 0.0)),
    turbulence_rate,
    check_turbulence,
)


def gusts(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """
    One gust with a one-minus-cosine rise and decay.

        U = (x, y, z) (1 - cos(pi s / length)) / 2,    DU/Dt = dU/dt

    s is the time since the begin or until the end, whichever is less, and at most `length`;
    between rise and decay the gust lasts for `hold`. The rise is the discrete gust of MIL-F-8785C,
    section 3.7.2, over the time in which the vehicle flies its length. A `hold` longer than the
    flight keeps it, as there; 0 gives the full wave of certification rules. The gust is the same
    everywhere, so all of its change is a pressure gradient, and an inviscid neutral hull follows
    it exactly.

    The memory is a clock [s]; it stops while there is no gust.
    """
    x, y, z, begin, length, hold = p
    since = memory[0] - begin
    until = 2.0 * length + hold - since
    # Distance from the nearer end; `length` during the hold
    edge = min(since, until, length)
    if edge <= 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    if edge == length:
        return (x, y, z, 0.0, 0.0, 0.0)
    phase = math.pi * edge / length
    share = 0.5 - 0.5 * math.cos(phase)
    slope = 0.5 * math.pi / length * math.sin(phase)
    # Falling in the second half
    slope = slope if since < until else -slope
    return (x * share, y * share, z * share, x * slope, y * slope, z * slope)


def gusts_rate(p: Values, memory: Values, place: AirEffectInput) -> Values:
    """Return the rate of the gust clock."""
    x, y, z, begin, length, hold = p  # noqa: RUF059
    # The clock counts flight time, only while the effect is on
    return (1.0 if length > 0.0 else 0.0,)


def check_gusts(values: Mapping[str, float]) -> str:
    """Return an objection to a gust without length: its pressure gradient would be unbounded."""
    if values['length'] <= 0.0 and any(values[axis] != 0.0 for axis in ('x', 'y', 'z')):
        return 'a gust needs its rise time; set length, in seconds'
    return ''


_GUSTS_WIND = 'spread: a door opened in a room (assumed); limits: stronger than any storm'
_TIME = 'spread: 0.5 s, about a metre at the speed of a small blimp (assumed)'

GUSTS = AirEffect(
    'gusts',
    (
        *declare_each(('x', 'y', 'z'), 'm/s', 0.0, -60.0, 60.0, 0.3, _GUSTS_WIND),
        EffectParameter('begin', 's', 0.0, 0.0, 1e5, 0.5, _TIME),
        EffectParameter('length', 's', 0.0, 0.01, 1e4, 0.5, _TIME),
        EffectParameter('hold', 's', 0.0, 0.0, 1e6, 0.5, _TIME),
    ),
    gusts,
    (('time', 0.0),),
    gusts_rate,
    check_gusts,
)
