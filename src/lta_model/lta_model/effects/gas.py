# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Lifting gas and outside air: purity, state, leak and warming by light."""

from typing import Final

from lta_config.constants import AIR_PRESSURE, AIR_TEMPERATURE, HELIUM_TO_AIR, STANDARD_GRAVITY
from lta_model.effects.protocol import (
    BodyEffect,
    EffectParameter,
    RigidBody,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import DISPLACED, IRRADIANCE


def gas_purity(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Helium purity that differs from the vehicle file.

        m' = m - purity (1 - rho_he / rho_air) m_d

    `purity` is the deviation of the volume fraction of helium, the rest being air; m_d is the mass
    of the displaced air, so 1 % of a 1 m balloon is 3.6 g. Densities are at one temperature and
    pressure, the volume is constant, and the air is at the hull centre. Not modelled: what that
    air adds to the inertia, of which `gas_rotation` has the larger part.
    """
    (purity,) = p
    # Purer gas is lighter at the same volume
    mass = rigid.mass - purity * (1.0 - HELIUM_TO_AIR) * rigid.displaced
    return RigidBody(mass, rigid.moment, rigid.inertia, rigid.displaced)


_GAS_PURITY_PURITY = (
    'spread: lift of 329 to 332 g instead of 356 g stated for the 1 m balloon, 112 '
    'instead of 163 g measured on a GT-MAB; 3 % around a given purity (assumed)'
)

GAS_PURITY = BodyEffect(
    'gas_purity',
    (EffectParameter('purity', '1', 0.0, -1.0, 1.0, 0.03, _GAS_PURITY_PURITY),),
    gas_purity,
)


def gas_state(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Gas that was filled warmer than the air, or under overpressure.

        m' = m + m_gas ((1 + overpressure / p_0) / (1 + dT / T_0) - 1)

    m_gas is the mass of the gas at p_0 = 101325 Pa and T_0 = 293.15 K, with which the model was
    built; the rest is the ideal gas law at the hull's volume. The mass is a separate parameter
    because it includes purity: pure helium weighs 0.14 of the displaced air, helium of 93 % 0.20.
    The vehicle sets it.

    The hull was *filled* to this state: warmer gas of the same pressure is less gas. `superheat`
    is for gas that warms in flight. For 80 g of gas 5 K are 1.3 g and 1 kPa is 0.8 g. The mass
    acts at the hull centre. Not modelled: its inertia.
    """
    gas, temperature, overpressure = p
    # Ideal gas at constant volume: mass goes with p / T
    colder = AIR_TEMPERATURE / (AIR_TEMPERATURE + temperature)
    more = (AIR_PRESSURE + overpressure) / AIR_PRESSURE * colder - 1.0
    return RigidBody(rigid.mass + gas * more, rigid.moment, rigid.inertia, rigid.displaced)


_GAS_STATE_GAS = 'follows from hull and purity; spread: 3 % of purity for 0.4 kg of displaced air'
_GAS_STATE_TEMPERATURE = 'spread: gas fresh from the bottle, or warmed by lamps (assumed)'
_GAS_STATE_OVERPRESSURE = (
    'spread: a foil balloon filled until taut (assumed); a limp film cannot hold a '
    'negative pressure'
)

GAS_STATE = BodyEffect(
    'gas_state',
    (
        EffectParameter('gas', 'kg', 0.0, 0.0, 100.0, 0.01, _GAS_STATE_GAS),
        EffectParameter('temperature', 'K', 0.0, -80.0, 80.0, 3.0, _GAS_STATE_TEMPERATURE),
        EffectParameter('overpressure', 'Pa', 0.0, -100.0, 1e4, 300.0, _GAS_STATE_OVERPRESSURE),
    ),
    gas_state,
)


def gas_rotation(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Gas that turns with the hull.

        I' = I + share (roll, pitch, yaw)

    The mass properties have the gas as an ideal fluid, which slips along the hull. `roll`, `pitch`
    and `yaw` are what it would have more if it were frozen to the hull, 4 m b^2 c^2 / (5 (b^2 +
    c^2)) with the half axes b and c across; the vehicle sets them. A share of 0 is the ideal
    fluid, 1 the frozen gas; of a vehicle that was swung as a whole, 0 is the gas as it turned.

    The oscillating boundary layer (Stokes) is d = sqrt(2 nu / omega) thick: 9 to 19 mm of helium
    at periods of 2 to 10 s. It drags a share of 3.7 d / r in yaw, of which 2.6 d / r is in phase:
    in a 1 m balloon 0.05 to 0.15. Inner walls, pillars and a limp film drag more.

    Not modelled: the damping by that layer, omega times its inertia (5e-4 to 1.2e-3 N m s in yaw
    of a 1 m balloon), that the share depends on the period, and spin-up: in a steady turn all of
    the gas turns after about 40 s.
    """
    share, roll, pitch, yaw = p
    i = rigid.inertia
    inertia = (
        i[0] + share * roll,
        i[1] + share * pitch,
        i[2] + share * yaw,
        i[3],
        i[4],
        i[5],
    )
    return RigidBody(rigid.mass, rigid.moment, inertia, rigid.displaced)


_GAS_ROTATION_SHARE = (
    'by definition from ideal fluid (0) to frozen (1); spread: walls or a limp film inside '
    '(assumed)'
)
_GAS_ROTATION_FROZEN = 'follows from hull and gas; spread: a tenth of a 1 m balloon; limit: 50 kg'

GAS_ROTATION = BodyEffect(
    'gas_rotation',
    (
        EffectParameter('share', '1', 0.0, 0.0, 1.0, 0.3, _GAS_ROTATION_SHARE),
        *(
            EffectParameter(axis, 'kg m2', 0.0, 0.0, 500.0, 5e-4, _GAS_ROTATION_FROZEN, beside=own)
            for axis, own in (('roll', 4.3e-3), ('pitch', 4.3e-3), ('yaw', 8.2e-3))
        ),
    ),
    gas_rotation,
)


def air_state(p: Values, rigid: RigidBody) -> RigidBody:
    """
    Air pressure and temperature that differ from those the model was built with.

        ratio = (1 + dp / p_0) / (1 + dT / T_0),    m_d' = m_d (1 + (1 - slack) (ratio - 1))

    m_d is the mass of the displaced air, p_0 = 101325 Pa and T_0 = 293.15 K; ratio is that of the
    densities (ideal gas law). A taut envelope (`slack` 0) keeps its volume and displaces air of
    the new density. A slack one (1) follows the pressure and temperature of the air, its volume
    goes with 1 / ratio, and it displaces the same mass. The mass of the gas stays. For a taut 1 m
    balloon 1 K is 1.4 g of lift and 1 hPa is 0.4 g. Not modelled: added mass and drag, which also
    go with the density (1.7 % at 5 K), and humidity.
    """
    pressure, temperature, slack = p
    # Density ratio by temperature at constant pressure (ideal gas)
    colder = AIR_TEMPERATURE / (AIR_TEMPERATURE + temperature)
    denser = (AIR_PRESSURE + pressure) / AIR_PRESSURE * colder - 1.0
    displaced = rigid.displaced * (1.0 + (1.0 - slack) * denser)
    return RigidBody(rigid.mass, rigid.moment, rigid.inertia, displaced)


_AIR_STATE_PRESSURE = (
    'spread: 10 hPa, from the weather (unverified, from memory); limits: 10 km '
    'altitude, a deep mine'
)
_AIR_STATE_TEMPERATURE = (
    'spread: rooms between 15 and 25 C (assumed); limits: temperatures in which people fly'
)
_AIR_STATE_SLACK = (
    'by definition from taut (0) to slack (1); spread: not known for a foil balloon (assumed)'
)

AIR_STATE = BodyEffect(
    'air_state',
    (
        EffectParameter('pressure', 'Pa', 0.0, -8e4, 2e4, 1e3, _AIR_STATE_PRESSURE),
        EffectParameter('temperature', 'K', 0.0, -80.0, 60.0, 5.0, _AIR_STATE_TEMPERATURE),
        EffectParameter('slack', '1', 0.0, 0.0, 1.0, 0.3, _AIR_STATE_SLACK),
    ),
    air_state,
)


def helium_leak(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Lift lost at a constant rate.

        F = -lost e_z,    d/dt lost = rate

    at the hull centre, e_z the map's vertical; `lost` is the memory [N]. Permeation through a film
    of constant area under a constant partial pressure, and the flow out of a hole under a constant
    overpressure, lose a constant volume per second: hence a rate in N/s and no time constant. With
    a lift density of (rho_air - rho_he) g = 10.2 N/m3:

        permeation   0.2 to 0.9 L/(m2 day) through 2.5 m2: 0.6 to 2.6e-7 N/s, 0.5 to 2.3 g a day
        a hole       0.6 A sqrt(2 dp / rho_he): 1 mm2 under 30 Pa loses 1.2e-4 N/s, 0.7 g a minute

    A negative rate is lift that grows, as while the gas warms.

    At a given memory the wrench is independent of the rate, so no parameter is declared linear.
    Not modelled: the mass of the lost helium (0.16 g for each gram of lift), loss of shape, air
    flowing in, and that a taut envelope loses overpressure before lift.
    """
    (rate,) = p
    lost, r = memory[0], motion.rotation
    if rate == 0.0:
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # Third row of R is the map's vertical in the body frame
    return (-lost * r[6], -lost * r[7], -lost * r[8], 0.0, 0.0, 0.0)


def helium_leak_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return d/dt of the lost lift."""
    (rate,) = p
    return (rate,)


_HELIUM_LEAK_RATE = (
    'airship laminates with 0.2 to 0.9 L/(m2 day) (Frontiers Mater. 2022, 992984) '
    'lose 2.6e-7 N/s at most; spread: a hole of 1 mm2 at 30 Pa (Bernoulli); limit: 10 '
    'g/s'
)

HELIUM_LEAK = WrenchEffect(
    'helium_leak',
    (EffectParameter('rate', 'N/s', 0.0, -0.1, 0.1, 1e-4, _HELIUM_LEAK_RATE),),
    helium_leak,
    memory=(('lost', 0.0),),
    rate=helium_leak_rate,
)


# Heat balance of the docstring below
IN_SUN: Final[dict[str, float]] = {'warming': 0.017, 'lag': 70.0}


def superheat(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Lift of gas warmed by light, where the envelope lets it expand.

        F = slack m_d g (theta / T) e_z,    d/dt theta = (warming E - theta) / lag

    at the hull centre; theta (memory) is the temperature of the gas above that of the air [K], E
    the irradiance on the hull, m_d the mass of the displaced air, T = 293.15 K that of the air,
    e_z the vertical. With `lag` 0 the gas is at its steady temperature.

    Gas in a slack envelope stays at air pressure, so its volume grows as theta / T (ideal gas law)
    at constant mass, and the lift grows by the newly displaced air (Archimedes). A taut foil
    balloon keeps its volume: its pressure grows by 346 Pa/K and its lift does not. `slack` is the
    share of the free expansion: 0 taut, 1 slack.

    Heat balance of an aluminised 1 m balloon, for the priors: it absorbs 0.14 E (solar absorptance
    of aluminised film, aluminium outside: Fortescue, Swinerd and Stark 2011, table 11.3) on 0.785
    m2 and loses h = 2.6 W/(m2 K) by free convection on 2.47 m2 (unverified, from memory; radiation
    is small, emittance 0.05), so warming = 0.017 K m2/W; gas 296 J/K and film 152 J/K (116.8 g at
    1.3 kJ/(kg K), unverified, from memory) over 6.4 W/K, so lag = 70 s. In `sunny_field` E is
    980 W/m2: 17 K and, slack, 23 g of lift when steady; 10 K and 13 g after a minute. `IN_SUN` has
    these values, for scenes with a sun, which have the slack; a vehicle file that has the effect
    has its own.

    Not modelled: forced convection by wind, stirring of the gas, one-sided sun, a change of T.
    """
    warming, lag, slack = p
    steady = warming * motion.surroundings[IRRADIANCE]
    # Without a lag the gas is at its steady temperature
    warmer = memory[0] if lag > 0.0 else steady
    weight = motion.body[DISPLACED] * STANDARD_GRAVITY
    # Volume grows with theta / T, and with it the displaced air
    lift = slack * weight * warmer / AIR_TEMPERATURE
    r = motion.rotation
    return (lift * r[6], lift * r[7], lift * r[8], 0.0, 0.0, 0.0)


def superheat_rate(p: Values, memory: Values, motion: VehicleMotion) -> Values:
    """Return d/dt of the temperature of the gas above that of the air."""
    warming, lag, slack = p  # noqa: RUF059 (the kernel knows parameters by their order)
    steady = warming * motion.surroundings[IRRADIANCE]
    return ((steady - memory[0]) / lag if lag > 0.0 else 0.0,)


_SUPERHEAT_WARMING = (
    'spread: from the heat balance; limit: ten times a black film with little convection'
)
_SUPERHEAT_LAG = (
    'spread: from the heat balance; limits: a thin film alone, a stratospheric balloon (assumed)'
)
_SUPERHEAT_SLACK = (
    'by definition from taut (0) to slack (1); spread: not known for a foil balloon (assumed)'
)

SUPERHEAT = WrenchEffect(
    'superheat',
    (
        EffectParameter('warming', 'K m2/W', 0.0, 0.0, 1.0, 0.01, _SUPERHEAT_WARMING),
        EffectParameter('lag', 's', 0.0, 1.0, 1e4, 40.0, _SUPERHEAT_LAG, beside=40.0),
        EffectParameter('slack', '1', 0.0, 0.0, 1.0, 0.3, _SUPERHEAT_SLACK, beside=0.3),
    ),
    superheat,
    ('slack',),
    memory=(('warmer', 0.0),),
    rate=superheat_rate,
)
