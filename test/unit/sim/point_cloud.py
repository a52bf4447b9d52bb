"""A rigid body as a cloud of points, to hold formulas of mass and inertia against."""

from lta_model.effects.protocol import RigidBody
import numpy as np


def of_points(masses, places, displaced):
    """Return the rigid body of points, summed with numpy."""
    r = np.array(places)
    tensor = sum(m * (x @ x * np.eye(3) - np.outer(x, x)) for m, x in zip(masses, r, strict=True))
    inertia = (*np.diag(tensor), tensor[0, 1], tensor[0, 2], tensor[1, 2])
    return RigidBody(sum(masses), tuple(np.array(masses) @ r), inertia, displaced)
