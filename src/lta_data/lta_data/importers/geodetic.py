"""Place latitude, longitude and altitude on a local map: east, north and up from the first fix."""

from typing import Final, final

from lta_data.importers.log_table import Numbers
import numpy as np

# WGS 84: equatorial radius [m] and first eccentricity squared
EQUATOR: Final = 6_378_137.0
ECCENTRICITY: Final = 6.694_379_990_14e-3


@final
class LocalMap:
    """
    A map about the first fix that it is given.

    Flat: 1 km from its origin it is off by some centimetres.
    """

    def __init__(self) -> None:
        self._origin: Numbers | None = None

    def project(self, fixes: Numbers) -> Numbers:
        """
        Return places east, north and up of the first fix, shape (n, 3). [m]

        `fixes`, shape (n, 3): latitude [deg], longitude [deg], altitude [m]; NaN without a fix, as
        in the result, where latitude and longitude are zero.
        """
        # A receiver without a fix writes zeros
        fixes = np.where((fixes[:, :2] == 0.0).all(axis=1)[:, None], np.nan, fixes)
        good = np.flatnonzero(np.isfinite(fixes).all(axis=1))
        if self._origin is None and len(good):
            self._origin = fixes[good[0]].copy()
        if self._origin is None:
            return np.full(fixes.shape, np.nan)
        north, east, up = (fixes - self._origin).T
        latitude = np.radians(self._origin[0])
        bend = 1.0 - ECCENTRICITY * np.sin(latitude) ** 2
        meridian = EQUATOR * (1.0 - ECCENTRICITY) / bend**1.5
        parallel = EQUATOR / np.sqrt(bend) * np.cos(latitude)
        # Over the date line
        east = (east + 180.0) % 360.0 - 180.0
        return np.stack([np.radians(east) * parallel, np.radians(north) * meridian, up], axis=1)
