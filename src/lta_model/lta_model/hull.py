"""Shape of a hull: its volume, its half axes and the air that moves with it."""

import math

from lta_config.errors import BadInput
from lta_config.quantity import Quantity
from lta_config.schema.vehicle_body import HullBlock
from lta_model.mass_matrix import Six, spheroid_added_mass


def _length_or_zero(quantity: Quantity | None) -> float:
    """Return a length validated by the reader; 0 where the shape has none."""
    return 0.0 if quantity is None else quantity.si


def hull_volume(hull: HullBlock) -> float:
    """Return the volume of the hull. [m3]."""
    if hull.shape == 'balloon':
        # Mylar balloon: its volume is a factor times the cube of the flat radius
        return _length_or_zero(hull.volume_factor) * (0.5 * _length_or_zero(hull.diameter)) ** 3
    a, b, c = half_axes(hull)
    return 4.0 / 3.0 * math.pi * a * b * c


def half_axes(hull: HullBlock) -> tuple[float, float, float]:
    """Return half the size along x, y, z; zeros where there is no hull. [m]."""
    radius = 0.5 * _length_or_zero(hull.diameter)
    axes = [radius, radius, radius]
    if hull.shape == 'balloon':
        # A balloon is flat along body z
        axes[2] = 0.5 * _length_or_zero(hull.height)
    elif hull.shape == 'spheroid':
        axes['xyz'.index(hull.axis or 'z')] = 0.5 * _length_or_zero(hull.length)
    return (axes[0], axes[1], axes[2])


def added_mass(hull: HullBlock, air_density: float) -> Six:
    """
    Return the added mass and inertia: as published, or that of a spheroid (Lamb 1932).

    Along x y z [kg] and about x y z [kg m2], for an air density [kg/m3]; published values are
    taken as they are. A balloon counts as the spheroid of its diameter and height.
    """
    if hull.added_mass:
        x, y, z = hull.added_mass.mass.vector
        k, m, n = hull.added_mass.inertia.vector
        return (x, y, z, k, m, n)
    if hull.shape == 'none':
        return (0.0,) * 6
    axis = hull.axis or 'z'
    axes = half_axes(hull)
    # Index - 1 is another axis, and the two others are equal
    along, across = axes['xyz'.index(axis)], axes['xyz'.index(axis) - 1]
    # Beyond these ratios a size is certainly wrong, for example in its unit
    if not 0.01 < along / across < 100.0:
        raise BadInput(
            f'The hull is {2 * along:g} m long and {2 * across:g} m wide, which is '
            'implausible; correct diameter, height or length under hull.'
        )
    return spheroid_added_mass(across, along, air_density, axis)
