"""Over what ground the paper's wind lets each strategy reach the lamp, in words."""

from collections.abc import Sequence
from typing import Final

from lta_studies.light.evaluation import labels, pilot
from lta_studies.light.evaluation.cells import EvaluationCell

MOST: Final = 0.5  # of the seeds, from which a ground counts as flown over


def describe_grounds(cells: Sequence[EvaluationCell]) -> str:
    """Return from what roughness on each strategy reaches the lamp; '' where none flew."""
    told = []
    for name in dict.fromkeys(cell.strategy for cell in cells if cell.strategy != pilot.NAME):
        own = [cell for cell in cells if cell.strategy == name]
        rough = [cell.place for cell in own if cell.reached_share.value > MOST]
        over = f'over {min(rough):g} m and more' if rough else 'over none of these grounds'
        told.append(f'{labels.label_strategy(name)} {over}')
    if not told:
        return ''
    return (
        'Against 8 m/s at 10 m most flights reach the lamp, by roughness of the ground: '
        f'{", ".join(told)}.'
    )
