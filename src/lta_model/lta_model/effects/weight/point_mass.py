"""
Add a point mass to a rigid body.

    m' = m + m_p,   (m r)' = m r + m_p r_p,   I' = I + m_p (|r_p|^2 1 - r_p r_p^T)

about the hull centre: the theorem of Steiner for a body without inertia of its own.
"""

from lta_model.effects.protocol import RigidBody, Vector


def with_point_mass(rigid: RigidBody, mass: float, place: Vector) -> RigidBody:
    """
    Return the body with a point mass [kg] at a place from the hull centre, body frame [m].

    A negative mass is removed.
    """
    x, y, z = place
    m, i = rigid.moment, rigid.inertia
    inertia = (
        i[0] + mass * (y * y + z * z),
        i[1] + mass * (x * x + z * z),
        i[2] + mass * (x * x + y * y),
        # Products of inertia are tensor elements, so they take a minus
        i[3] - mass * x * y,
        i[4] - mass * x * z,
        i[5] - mass * y * z,
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(rigid.mass + mass, moment, inertia, rigid.displaced)
