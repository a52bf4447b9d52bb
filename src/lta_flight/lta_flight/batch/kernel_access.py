"""Access of the batch model to the numbers of one vehicle, as local variables."""

from typing import final

from lta_sim.kernels.columns import build_thread_sources
from lta_sim.kernels.layout import EffectLayout, FIXED, format_tuple, indent_lines, ModelStage

# Constant arrays of a vehicle, in the order of the row `fixed`
KEPT = ('parameters', 'body', 'inverse')


@final
class VehicleAccess:
    """One vehicle: its constants are a row `fixed`, all else has its own name."""

    loops = False

    def format_number(self, name: str, place: int, layout: EffectLayout, each: int = 0) -> str:
        """Return the source of one number; `each` is unused, because there are no loops."""
        del each
        return (
            f'fixed[{self._row_offset(name, layout) + place}]'
            if name in KEPT
            else f'{name}[{place}]'
        )

    def format_all_numbers(self, name: str, layout: EffectLayout) -> str:
        """Return the source of all numbers of an array."""
        if name not in KEPT:
            return name
        return format_tuple(self.format_number(name, k, layout) for k in range(FIXED[name]))

    def build_template_parts(
        self, parts: list[ModelStage], layout: EffectLayout
    ) -> dict[str, str]:
        """Return the model for a thread, and the stages that compute the thrusts."""
        lines = [line for part in parts if part.writes == ('u',) for line in part.lines]
        return {**build_thread_sources(parts, layout), 'actuation': indent_lines(lines)}

    def _row_offset(self, name: str, layout: EffectLayout) -> int:
        counts = {'parameters': layout.parameters, **FIXED}
        return sum(counts[name_before] for name_before in KEPT[: KEPT.index(name)])
