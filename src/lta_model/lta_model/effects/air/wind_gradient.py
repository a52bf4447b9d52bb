"""
Steady wind with a constant spatial gradient.

    U = G (r - r_0),    DU/Dt = G (U_before + U),    G_zz = -(G_xx + G_yy)

in `map`; G_ij is d U_i / d r_j and `x_y` its element for i = x, j = y. The air is incompressible,
so the last element follows from the others. U_before is the wind of the surroundings and of the
effects before this one: put a uniform part into `steady_wind`. The wind of later effects does not
contribute to DU/Dt.

An antisymmetric G is a rigid rotation with a pressure gradient towards its axis, as in an eddy.
The force on a hull small against the scale of G is that of Auton, Hunt and Prud'homme 1988
(J. Fluid Mech. 197, doi 10.1017/S0022112088003246). Not modelled: the moment of a strain on a long
hull, and the lift of vorticity.
"""

from lta_model.effects.protocol import AirEffect, AirEffectInput, EffectParameter, Values, Wrench

_SOURCE = (
    'spread: 0.05 m/s over a metre, an indoor draught; limits: that in a vortex ring '
    '(both assumed)'
)
_PLACE = 'spread: 1 m (assumed); limits: a large hall'

PARAMETERS = (
    *(EffectParameter(axis, 'm', 0.0, -1e3, 1e3, 1.0, _PLACE) for axis in ('x', 'y', 'z')),
    *(
        EffectParameter(name, '1/s', 0.0, -10.0, 10.0, 0.05, _SOURCE)
        for name in ('x_x', 'x_y', 'x_z', 'y_x', 'y_y', 'y_z', 'z_x', 'z_y')
    ),
)


def compute_air_motion(p: Values, memory: Values, place: AirEffectInput) -> Wrench:
    """Return the wind at the hull and its material derivative."""
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


EFFECT = AirEffect('wind_gradient', PARAMETERS, compute_air_motion)
