"""
A point mass fixed to a vehicle.

    m' = m + m_p,   (m r)' = m r + m_p r_p,   I' = I + m_p (|r_p|^2 1 - r_p r_p^T)

about the hull centre: the theorem of Steiner for a body without inertia of its own.
"""

from lta_model.effects.protocol import RigidBody, Vector


def add_point_mass(rigid: RigidBody, mass: float, place: Vector) -> RigidBody:
    """
    Return the vehicle with a point mass.

    Parameters
    ----------
    rigid : Rigid
        The vehicle without it.
    mass : float
        The mass; negative takes it away. [kg]
    place : 3-tuple
        Where it is, from the hull centre, body frame. [m]

    Returns
    -------
    Rigid
        The vehicle with it.

    """
    x, y, z = place
    m, i = rigid.moment, rigid.inertia
    inertia = (
        i[0] + mass * (y * y + z * z),
        i[1] + mass * (x * x + z * z),
        i[2] + mass * (x * x + y * y),
        i[3] - mass * x * y,
        i[4] - mass * x * z,
        i[5] - mass * y * z,
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(rigid.mass + mass, moment, inertia, rigid.displaced)
