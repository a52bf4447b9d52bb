"""How the model of a flight of a batch reaches its numbers: one vehicle in local variables."""

from typing import final

from lta_sim.kernels.columns import thread
from lta_sim.kernels.layout import FIXED, indented, Layout, Stage, tuple_of

# What the kernel keeps of a vehicle during a flight, in this order.
KEPT = ('parameters', 'body', 'inverse')


@final
class Kept:
    """One vehicle: what it keeps is a row `fixed`, the rest under its own name."""

    loops = False

    def item(self, name: str, place: int, layout: Layout, each: int = 0) -> str:
        """Return the source of one number; there are no loops, so `each` says nothing."""
        del each
        return (
            f'fixed[{self._first(name, layout) + place}]' if name in KEPT else f'{name}[{place}]'
        )

    def whole(self, name: str, layout: Layout) -> str:
        """Return the source of all numbers of a name."""
        if name not in KEPT:
            return name
        return tuple_of(self.item(name, k, layout) for k in range(FIXED[name]))

    def texts(self, parts: list[Stage], layout: Layout) -> dict[str, str]:
        """Return the model as a thread has it, and the stages that end in thrusts."""
        lines = [line for part in parts if part.writes == ('u',) for line in part.lines]
        return {**thread(parts, layout), 'actuation': indented(lines)}

    def _first(self, name: str, layout: Layout) -> int:
        counts = {'parameters': layout.parameters, **FIXED}
        return sum(counts[known] for known in KEPT[: KEPT.index(name)])
