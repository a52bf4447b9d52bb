# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Air that moves with the hull: added mass and inertia, and the moment that they cause."""

from lta_model.effects.protocol import (
    AXES,
    declare_each,
    EffectParameter,
    InertiaEffect,
    Values,
    VehicleMotion,
    Wrench,
    WrenchEffect,
)
from lta_model.state import ADDED


def added_mass(p: Values) -> Wrench:
    """
    Inertia of the air that accelerates with the hull: added mass.

        A_1 = diag(surge, sway, heave)

    about the hull centre. Its momentum follows the air-relative velocity (`rigid_body`), which
    includes the Munk moment. `mass_properties.spheroid_added_mass` has Lamb's closed forms for
    spheroids. Not modelled: coupling terms of hulls without three planes of symmetry, nearby walls
    and floor.
    """
    surge, sway, heave = p
    return (surge, sway, heave, 0.0, 0.0, 0.0)


_ADDED_MASS_SOURCE = (
    'Lamb 1932 art. 114; spread: 10 % of that of a 0.4 kg hull, because real flow separates'
)

ADDED_MASS = InertiaEffect(
    'added_mass',
    declare_each(AXES[:3], 'kg', 0.0, 0.0, 100.0, 0.03, _ADDED_MASS_SOURCE),
    added_mass,
)


def added_inertia(p: Values) -> Wrench:
    """
    Rotational inertia of the air that turns with the hull: added inertia.

        A_2 = diag(roll, pitch, yaw)

    about the hull centre. It is zero for a sphere and about an axis of revolution in an ideal
    fluid; `mass_properties.spheroid_added_mass` has Lamb's closed forms for spheroids. Not
    modelled: coupling terms and the boundary layer.
    """
    roll, pitch, yaw = p
    return (0.0, 0.0, 0.0, roll, pitch, yaw)


_ADDED_INERTIA_SOURCE = (
    'Lamb 1932 art. 115; spread: 10 % of that of an oblate hull with a diameter of 1 m'
)

ADDED_INERTIA = InertiaEffect(
    'added_inertia',
    declare_each(AXES[3:], 'kg m2', 0.0, 0.0, 100.0, 5e-4, _ADDED_INERTIA_SOURCE),
    added_inertia,
)


def munk_moment(p: Values, memory: Values, motion: VehicleMotion, thrust: Values) -> Wrench:
    """
    Reduction of the Munk moment by flow separation behind a real hull.

        N = lost (v x A v)

    about the hull centre; v is the air-relative velocity, A the added mass. The rigid body has the
    full moment -v x A v of attached flow (Munk 1924, NACA Report 184), which turns the hull
    broadside on. Behind a real hull the flow separates and the rear carries less load (Allen and
    Perkins 1951, NACA Report 1048), so a share `lost` of it is missing. The moment is at most half
    the difference of two added masses times |v|^2, and does not brake the hull. Not modelled:
    dependence on the angle.
    """
    (lost,) = p
    x, y, z = motion.airspeed
    a, b, c = motion.body[ADDED], motion.body[ADDED + 1], motion.body[ADDED + 2]
    return (
        0.0,
        0.0,
        0.0,
        # v x A v for the diagonal A = (a, b, c)
        lost * (c - b) * y * z,
        lost * (a - c) * z * x,
        lost * (b - a) * x * y,
    )


_SHARE = (
    'Hoerner 1965: wind tunnels show a smaller moment than Munk (unverified, from memory); '
    'spread: 0.2'
)

MUNK_MOMENT = WrenchEffect(
    'munk_moment',
    (EffectParameter('lost', '1', 0.0, -0.5, 1.0, 0.2, _SHARE),),
    munk_moment,
    linear_in=('lost',),
)
