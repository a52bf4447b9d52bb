"""
A vehicle with its centre of gravity elsewhere, all else kept.

    r' = r + d,   I' = I + m ((2 r.d + d.d) 1 - r d^T - d r^T - d d^T)

The mass and the inertia about the CG stay; that about the hull centre follows by the theorem of
Steiner, I = I_cg + m (|r|^2 1 - r r^T), taken at r + d and at r. Written as a difference, it needs
no division by the mass and is exactly nothing for d = 0.
"""

from lta_model.effects.protocol import RigidBody, Vector


def shift_cg(rigid: RigidBody, shift: Vector) -> RigidBody:
    """
    Return the vehicle with its centre of gravity shifted.

    Parameters
    ----------
    rigid : Rigid
        The vehicle as it was.
    shift : 3-tuple
        Shift of the centre of gravity, body frame. [m]

    Returns
    -------
    Rigid
        The vehicle as it is.

    """
    x, y, z = shift
    m, mass, i = rigid.moment, rigid.mass, rigid.inertia
    s_x = (2.0 * m[0] + mass * x) * x
    s_y = (2.0 * m[1] + mass * y) * y
    s_z = (2.0 * m[2] + mass * z) * z
    inertia = (
        i[0] + s_y + s_z,
        i[1] + s_x + s_z,
        i[2] + s_x + s_y,
        i[3] - (m[0] * y + m[1] * x + mass * x * y),
        i[4] - (m[0] * z + m[2] * x + mass * x * z),
        i[5] - (m[1] * z + m[2] * y + mass * y * z),
    )
    moment = (m[0] + mass * x, m[1] + mass * y, m[2] + mass * z)
    return RigidBody(mass, moment, inertia, rigid.displaced)
