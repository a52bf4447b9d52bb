"""
Logarithmic wind profile over rough ground, averaged over the height of the hull.

    U(z) = U_ref ln(z / z_0) / ln(h_ref / z_0)   for z > z_0,   else 0
    mean over z - h .. z + h = U_ref (F(z + h) - F(z - h)) / (2 h ln(h_ref / z_0))
    F(z) = z (ln(z / z_0) - 1) + z_0             for z > z_0,   else 0
    DU/Dt = W d/dz (mean U)

U_ref = (x, y) is the wind at the reference height in `map`, as the direction of the flow; z_0 is
the roughness length, h half the height of the hull, W the vertical wind of the effects before this
one. F is the integral of the profile with a continuous slope, so the wind on the hull is smooth
and finite down to the floor. h = 0 gives the profile itself.

Log law of the neutral surface layer (Prandtl; WMO-No. 8 takes the wind at 10 m). Among the
roughness elements it is only an approximation: at 0.5 m over z_0 = 0.3 m, try other z_0 as well.
Not modelled: displacement height, stability, weighting of slices by their width.
"""

from collections.abc import Mapping
import math

from lta_model.effects.protocol import AirEffect, AirEffectInput, EffectParameter, Values, Wrench

_WIND = (
    'spread: 0.5 m/s, the error of a hand anemometer (assumed); limits: stronger than any storm'
)
_HEIGHT = 'WMO-No. 8: 10 m (unverified, from memory); spread: 1 m (assumed)'
_ROUGHNESS = (
    'limits: 0.01 mm (ice) and 5 m (city), unverified, from memory; spread: a third of 0.3 m'
)
_HULL = 'half the height of the hull, from its shape; spread: 1 cm'

PARAMETERS = (
    EffectParameter('x', 'm/s', 0.0, -60.0, 60.0, 0.5, _WIND),
    EffectParameter('y', 'm/s', 0.0, -60.0, 60.0, 0.5, _WIND),
    EffectParameter('height', 'm', 10.0, 0.1, 300.0, 1.0, _HEIGHT),
    EffectParameter('roughness', 'm', 0.0, 1e-5, 5.0, 0.1, _ROUGHNESS),
    EffectParameter('half_height', 'm', 0.0, 0.01, 10.0, 0.01, _HULL),
)


def compute_air_motion(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """Return the wind averaged over the hull."""
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


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a reference wind without rough ground."""
    if values['x'] == 0.0 and values['y'] == 0.0:
        return ''
    if values['roughness'] <= 0.0:
        return 'a wind profile needs the roughness length of the ground; set roughness, in metres'
    if values['height'] <= values['roughness']:
        return 'height (the reference height) must be larger than roughness (the roughness length)'
    return ''


EFFECT = AirEffect('wind_profile', PARAMETERS, compute_air_motion, check=find_conflict)
