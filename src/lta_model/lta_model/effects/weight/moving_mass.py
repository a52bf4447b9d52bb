"""
Weight of a mass that is moved within the vehicle, as in RGBlimp.

    N = d x (-mass g e_z),    d/dt d = (c - r_0 - d) / lag,   no faster than `speed`

d (memory) is the displacement of the mass from r_0 = (x, y, z), its place when the vehicle was
weighed and at the start of a flight; c is the commanded place (`state.MASS_PLACE`, body frame),
e_z the map's vertical. The vehicle's weight includes the mass, so only the moment changes: the
tilt at rest is atan(mass d / (m depth)) for a vehicle of mass m with its CG at that depth. `lag`
0: the mass is at the commanded place. `speed` 0: no limit; it limits the length of the velocity,
so the path stays straight.

Not modelled, with figures for RGBlimp (54 g of 159 g, +-4 cm, 7.5 cm ahead of and 24 cm below the
hull centre): the inertia, 4.1e-4 of 1.9e-2 kg m2 in pitch (2.2 %) and 5.1e-4 kg m2 of its xz
product; the shift of the CG in accelerations, a / g of this moment (3 % at 0.3 m/s2); and the
recoil, 54/159 of the stroke of the mass, 1.4 cm, which sums to zero over a move.
"""

from collections.abc import Mapping
import math

from lta_config.constants import STANDARD_GRAVITY
from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect
from lta_model.state import MASS_PLACE

_PLACE = 'spread: 5 mm for a measured position (assumed); limits: a hull of 10 m'

PARAMETERS = (
    EffectParameter(
        'mass', 'kg', 0.0, 0.0, 50.0, 5e-4,
        'spread: 1 % of the 54.07 g of RGBlimp (zhu-yj/ABNODE@138a1de), weighed',
    ),
    EffectParameter('x', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
    EffectParameter('y', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
    EffectParameter('z', 'm', 0.0, -5.0, 5.0, 0.005, _PLACE),
    EffectParameter(
        'lag', 's', 0.0, 0.01, 100.0, 0.1,
        'spread: small servos settle within tenths of a second (assumed)',
    ),
    EffectParameter(
        'speed', 'm/s', 0.0, 1e-4, 10.0, 0.05,
        'spread: small servos move by centimetres in tenths of a second (assumed)',
    ),
)  # fmt: skip


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the moment of the displaced weight."""
    mass, x, y, z, lag, speed = p  # noqa: RUF059 (the kernel knows parameters by their order)
    c = motion.command
    # Without a lag the mass follows the command at once
    d_x = memory[0] if lag > 0.0 else c[MASS_PLACE] - x
    d_y = memory[1] if lag > 0.0 else c[MASS_PLACE + 1] - y
    d_z = memory[2] if lag > 0.0 else c[MASS_PLACE + 2] - z
    weight, up = mass * STANDARD_GRAVITY, motion.rotation
    return (
        0.0,
        0.0,
        0.0,
        # d x (-mass g e_z), with e_z in the third row of R
        -weight * (d_y * up[8] - d_z * up[7]),
        -weight * (d_z * up[6] - d_x * up[8]),
        -weight * (d_x * up[7] - d_y * up[6]),
    )


def compute_memory_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return the velocity of the mass in the vehicle."""
    mass, x, y, z, lag, speed = p  # noqa: RUF059 (the kernel knows parameters by their order)
    c = motion.command
    if lag <= 0.0:
        return (0.0, 0.0, 0.0)
    # First-order approach to the commanded displacement
    v_x = (c[MASS_PLACE] - x - memory[0]) / lag
    v_y = (c[MASS_PLACE + 1] - y - memory[1]) / lag
    v_z = (c[MASS_PLACE + 2] - z - memory[2]) / lag
    fast = math.sqrt(v_x * v_x + v_y * v_y + v_z * v_z)
    # Scale the whole vector, so that the path stays straight
    share = speed / fast if 0.0 < speed < fast else 1.0
    return (share * v_x, share * v_y, share * v_z)


def find_conflict(values: Mapping[str, float]) -> str:
    """Return an objection to a speed limit without lag: the mass would chatter about its goal."""
    if values['speed'] > 0.0 and values['lag'] == 0.0:
        return 'a speed limit needs a time constant; set lag, or leave speed at zero'
    return ''


EFFECT = WrenchEffect(
    'moving_mass',
    PARAMETERS,
    compute_wrench,
    ('mass',),
    memory=(('x', 0.0), ('y', 0.0), ('z', 0.0)),
    rate=compute_memory_rate,
    check=find_conflict,
)
