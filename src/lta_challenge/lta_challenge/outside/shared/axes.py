"""Rotate vectors between map and body axes, in scalar form for code generation."""

from lta_model.effects.protocol import Values

Vector = tuple[float, float, float]


def rotate_to_body(rotation: Values, x: float, y: float, z: float) -> Vector:
    """Rotate a vector from map to body axes; `rotation` is row by row."""
    r = rotation
    return (
        r[0] * x + r[3] * y + r[6] * z,
        r[1] * x + r[4] * y + r[7] * z,
        r[2] * x + r[5] * y + r[8] * z,
    )


def horizontal_components(rotation: Values, a: float, b: float, c: float) -> tuple[float, float]:
    """Return the map's x and y components of a vector in body axes."""
    r = rotation
    # First two rows of R
    return (r[0] * a + r[1] * b + r[2] * c, r[3] * a + r[4] * b + r[5] * c)
