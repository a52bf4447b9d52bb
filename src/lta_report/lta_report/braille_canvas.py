"""A terminal canvas of braille characters with two by four dots each."""

import math
from typing import Final, final

from rich.text import Text

BLANK: Final = 0x2800  # code point of the blank braille pattern
# Bit of each dot by row and column. The last row was added to braille later
BITS: Final = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))


@final
class BrailleCanvas:
    """
    Dots and letters; the first row of characters is at the top.

    Parameters
    ----------
    width, height : int
        In characters.

    """

    def __init__(self, width: int, height: int) -> None:
        self.width, self.height = width, height
        self._dots = [[0] * width for _ in range(height)]
        self._styles: dict[tuple[int, int], str] = {}
        self._letters: dict[tuple[int, int], tuple[str, str]] = {}

    def draw_dot(self, x: float, y: float, style: str = '') -> None:
        """Set a dot, x from the left and y from the top, in dots; the last style wins."""
        column, row = math.floor(x), math.floor(y)
        # Points outside the canvas are clipped
        if 0 <= column < 2 * self.width and 0 <= row < 4 * self.height:
            self._dots[row // 4][column // 2] |= BITS[row % 4][column % 2]
            self._styles[row // 4, column // 2] = style

    def draw_letter(self, x: float, y: float, letter: str, style: str) -> None:
        """Put a letter on the character that holds a dot; the first letter stays."""
        place = (math.floor(y) // 4, math.floor(x) // 2)
        if 0 <= place[0] < self.height and 0 <= place[1] < self.width:
            self._letters.setdefault(place, (letter, style))

    def render_lines(self) -> list[Text]:
        """Return the picture as rows of characters."""
        return [self._render_line(row) for row in range(self.height)]

    def render_text(self) -> Text:
        """Return the picture as one text."""
        found = Text()
        for line in self.render_lines():
            found.append_text(line).append('\n')
        return found

    def _render_line(self, row: int) -> Text:
        """Return one row of characters."""
        found = Text()
        for column, bits in enumerate(self._dots[row]):
            letter = self._letters.get((row, column))
            if letter:
                found.append(*letter)
            else:
                style = self._styles.get((row, column), '')
                # An empty character is a space, because some fonts draw the blank pattern as
                # circles
                found.append(chr(BLANK + bits) if bits else ' ', style)
        return found
