"""
Shift the centre of gravity of a rigid body.

    r' = r + d,   I' = I + m ((2 r.d + d.d) 1 - r d^T - d r^T - d d^T)

Mass and inertia about the CG stay. The inertia about the hull centre follows by the theorem of
Steiner, I = I_cg + m (|r|^2 1 - r r^T), at r + d and at r. As a difference it needs no division by
the mass and is exactly zero for d = 0.
"""

from lta_model.effects.protocol import RigidBody, Vector


def with_cg_shifted(rigid: RigidBody, shift: Vector) -> RigidBody:
    """Return the body with its centre of gravity shifted by a vector in the body frame. [m]"""
    x, y, z = shift
    m, mass, i = rigid.moment, rigid.mass, rigid.inertia
    # m ((x + dx)^2 - x^2) = (2 m x + m dx) dx, with m x the stored moment
    s_x = (2.0 * m[0] + mass * x) * x
    s_y = (2.0 * m[1] + mass * y) * y
    s_z = (2.0 * m[2] + mass * z) * z
    inertia = (
        i[0] + s_y + s_z,
        i[1] + s_x + s_z,
        i[2] + s_x + s_y,
        # Products of inertia are tensor elements, so they take a minus
        i[3] - (m[0] * y + m[1] * x + mass * x * y),
        i[4] - (m[0] * z + m[2] * x + mass * x * z),
        i[5] - (m[1] * z + m[2] * y + mass * y * z),
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(mass, moment, inertia, rigid.displaced)
