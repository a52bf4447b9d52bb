"""
Measured drag of a smooth sphere, for the validation of the tunnel.

Morrison 2013, An Introduction to Fluid Mechanics, fits all Reynolds numbers up to 1e6 in one
formula; Achenbach 1972 (J. Fluid Mech. 54:565) measured 0.45 to 0.50 between 5e4 and 1.2e5, where
Morrison's formula gives 0.41. A real sphere lies within that scatter.
"""

from typing import Final

SCATTER: Final = (0.45, 0.50)  # measured drag coefficients between these Reynolds numbers
# Slightly beyond the measured range: the drag stays level up to about 2e5.
SCATTER_RANGE: Final = (5e4, 1.4e5)


def morrison_drag_coefficient(reynolds: float) -> float:
    """Return the drag coefficient of a smooth sphere on its frontal area. [1]."""
    fifth, crisis = reynolds / 5.0, reynolds / 2.63e5
    coefficient: float = (
        24.0 / reynolds
        + 2.6 * fifth / (1.0 + fifth**1.52)
        + 0.411 * crisis**-7.94 / (1.0 + crisis**-8.0)
        + 0.25 * (reynolds / 1e6) / (1.0 + reynolds / 1e6)
    )
    return coefficient


def relative_deviation(coefficient: float, reynolds: float) -> float:
    """
    Return the relative deviation of a coefficient from measurements, 0 within their scatter. [1]

    The scatter spans from Morrison's formula to the highest measured value.
    """
    low = high = morrison_drag_coefficient(reynolds)
    if SCATTER_RANGE[0] <= reynolds <= SCATTER_RANGE[1]:
        low, high = min(low, SCATTER[0]), max(high, SCATTER[1])
    if coefficient < low:
        return coefficient / low - 1.0
    return max(coefficient / high - 1.0, 0.0)
