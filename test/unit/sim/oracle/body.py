# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""What a vehicle weighs and displaces: lumps put together by the theorem of Steiner."""

import numpy as np

from .parameters import AXES, HELIUM, P_AIR, T_AIR


def about(place):
    """Return the inertia of a unit mass at a place, about the origin."""
    return (place @ place) * np.eye(3) - np.outer(place, place)


def with_lump(mass, cg, inertia, lump, place):
    """Return mass, CG and inertia about it with a point mass more."""
    total = mass + lump
    centre = (mass * cg + lump * place) / total
    whole = inertia + mass * about(cg - centre) + lump * about(place - centre)
    return total, centre, whole


def gas_purity(p, mass, cg, inertia, displaced):
    air_for_helium = -p('purity') * displaced * (1.0 - HELIUM)
    return *with_lump(mass, cg, inertia, air_for_helium, np.zeros(3)), displaced


def gas_state(p, mass, cg, inertia, displaced):
    density = (P_AIR + p('overpressure')) / P_AIR * T_AIR / (T_AIR + p('temperature'))
    more = p('gas') * (density - 1.0)
    return *with_lump(mass, cg, inertia, more, np.zeros(3)), displaced


def gas_rotation(p, mass, cg, inertia, displaced):
    turning = p('share') * np.diag(p.vector('roll', 'pitch', 'yaw'))
    return mass, cg, inertia + turning, displaced


def air_state(p, mass, cg, inertia, displaced):
    density = (P_AIR + p('pressure')) / P_AIR * T_AIR / (T_AIR + p('temperature'))
    share = p('slack') + (1.0 - p('slack')) * density
    return mass, cg, inertia, displaced * share


def carried(p, mass, cg, inertia, displaced):
    return *with_lump(mass, cg, inertia, p('mass'), p.vector('x', 'y', 'z')), displaced


def cg_moved(p, mass, cg, inertia, displaced):
    return mass, cg + p.vector('x', 'y', 'z'), inertia, displaced


BODY = {
    'gas_purity': gas_purity,
    'gas_state': gas_state,
    'gas_rotation': gas_rotation,
    'air_state': air_state,
    'ballast': carried,
    'payload': carried,
    'cg_height': cg_moved,
    'cg_offset': cg_moved,
}


def added_mass(p):
    return np.concatenate([p.vector(*AXES[:3]), np.zeros(3)])


def added_inertia(p):
    return np.concatenate([np.zeros(3), p.vector(*AXES[3:])])


INERTIA = {'added_mass': added_mass, 'added_inertia': added_inertia}
