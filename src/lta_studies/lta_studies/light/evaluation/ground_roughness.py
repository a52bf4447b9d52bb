"""Describe over which ground each strategy reaches the lamp in the paper's wind."""

from collections.abc import Sequence
from typing import Final

from lta_studies.light.evaluation import labels, pilot
from lta_studies.light.evaluation.cells import EvaluationCell

MOST: Final = 0.5  # share of seeds that counts as most flights


def describe_grounds(cells: Sequence[EvaluationCell]) -> str:
    """Return the smallest roughness at which each strategy arrives; '' if none flew."""
    parts = []
    for name in dict.fromkeys(cell.strategy for cell in cells if cell.strategy != pilot.NAME):
        own = [cell for cell in cells if cell.strategy == name]
        rough = [cell.place for cell in own if cell.reached_share.value > MOST]
        over = f'over {min(rough):g} m and more' if rough else 'over none of these grounds'
        parts.append(f'{labels.label_strategy(name)} {over}')
    if not parts:
        return ''
    return (
        'Against a wind of 8 m/s at 10 m height, most flights reach the lamp if the '
        f'roughness of the ground is large enough: {", ".join(parts)}.'
    )
