"""
Lift lost at a constant rate.

    F = -lost e_z,    d/dt lost = rate

at the hull centre, e_z the map's vertical; `lost` is the memory [N]. Permeation through a film of
constant area under a constant partial pressure, and the flow out of a hole under a constant
overpressure, lose a constant volume per second: hence a rate in N/s and no time constant. With a
lift density of (rho_air - rho_he) g = 10.2 N/m3:

    permeation   0.2 to 0.9 L/(m2 day) through 2.5 m2: 0.6 to 2.6e-7 N/s, 0.5 to 2.3 g a day
    a hole       0.6 A sqrt(2 dp / rho_he): 1 mm2 under 30 Pa loses 1.2e-4 N/s, 0.7 g a minute

A negative rate is lift that grows, as while the gas warms.

At a given memory the wrench is independent of the rate, so no parameter is declared linear. Not
modelled: the mass of the lost helium (0.16 g for each gram of lift), loss of shape, air flowing
in, and that a taut envelope loses overpressure before lift.
"""

from lta_model.effects.protocol import EffectParameter, Values, VehicleMotion, Wrench, WrenchEffect

PARAMETERS = (
    EffectParameter(
        'rate', 'N/s', 0.0, -0.1, 0.1, 1e-4,
        'airship laminates with 0.2 to 0.9 L/(m2 day) (Frontiers Mater. 2022, 992984) '
        'lose 2.6e-7 N/s at most; spread: a hole of 1 mm2 at 30 Pa (Bernoulli); limit: 10 '
        'g/s',
    ),
)  # fmt: skip


def compute_wrench(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """Return the loss of lift as a force."""
    (rate,) = p
    lost, r = memory[0], motion.rotation
    if rate == 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Third row of R is the map's vertical in the body frame
    return (-lost * r[6], -lost * r[7], -lost * r[8], 0.0, 0.0, 0.0)


def compute_memory_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return d/dt of the lost lift."""
    (rate,) = p
    return (rate,)


EFFECT = WrenchEffect(
    'helium_leak', PARAMETERS, compute_wrench, memory=(('lost', 0.0),), rate=compute_memory_rate
)
