"""
What a study says, as plain data: the JSON, the page and the learned vehicle file derive from it.

Nothing here is computed, and nothing here knows arrays of a flight.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final, Literal, NamedTuple

from lta_discovery.selection.detection_limit import DetectionLimit
from lta_discovery.unmodeled.draught import DraughtFinding
from lta_discovery.unmodeled.remainders import Remainder

Verdict = Literal['none', 'named', 'unexplained', 'named+unexplained', 'not_identifiable']
Interval = tuple[float, float]

SCHEMA: Final = 1  # of discovery.json


@final
class ParameterEstimate(NamedTuple):
    """
    One parameter of an effect.

    Attributes
    ----------
    name : str
        Within the effect.
    unit : str
        SI; '1' for a pure number.
    before : float
        What the vehicle file had; the null value where the effect was off.
    value : float
        Most probable, by all flights that taught and confirmed it.
    ci95 : pair of float
        95 % interval.
    in_file : bool
        Whether the vehicle file has the effect at all.

    """

    name: str
    unit: str
    before: float
    value: float
    ci95: Interval
    in_file: bool = True


@final
class LadderRung(NamedTuple):
    """
    One candidate of one round of the ladder of evidence.

    Attributes
    ----------
    knob : str
        What was tried: 'linear_drag.surge', or a generic rival.
    train, confirm, carried : float
        Log evidence won on the training flights; on the confirming ones by themselves; and on
        those under what the training flights taught. [nats]
    apart : float
        Difference of the two values, in deviations.
    accepted : bool
        Whether it earned its name.

    """

    knob: str
    train: float
    confirm: float
    carried: float
    apart: float
    accepted: bool

    @property
    def total(self) -> float:
        """Evidence that counts: of the training flights and the better witness. [nats]"""
        return self.train + max(self.confirm, self.carried)


@final
class AssumedValue(NamedTuple):
    """
    One number of an effect that no flight was asked for.

    Attributes
    ----------
    name, unit : str, str
        Within the effect; SI.
    value : float
        What it was taken to be.

    """

    name: str
    unit: str
    value: float


@final
@dataclass(frozen=True, slots=True)
class NamedEffect:
    """
    An effect that was found missing.

    Attributes
    ----------
    name : str
        Of the registry.
    knobs : tuple of str
        Those of its directions that were named, in the order in which they were.
    parameters : tuple of Learned
        Of it.
    log_evidence : float
        What removing it would cost on all flights that taught and confirmed it. [nats]
    confusable_with : tuple of str
        Knobs that these flights cannot tell from it.
    assumed : tuple of Assumed
        Numbers of it that the vehicle file lacks and that were not fitted. The values of
        `parameters` hold with these, and their intervals do not know them to be uncertain.

    """

    name: str
    knobs: tuple[str, ...]
    parameters: tuple[ParameterEstimate, ...]
    log_evidence: float
    confusable_with: tuple[str, ...] = ()
    assumed: tuple[AssumedValue, ...] = ()


@final
class Discrepancy(NamedTuple):
    """
    Where and when the model of the vehicle file disagrees.

    Attributes
    ----------
    flight : str
        Name of the bag.
    channel : str
        Of CHANNELS, or an axis of the wrench: 'surge' to 'yaw'.
    from_s, to_s : float
        Since the start of the flight. [s]
    condition : str
        'always', 'airspeed above 0.4 m/s', 'after 43 s': what tells this from the rest.
    ratio_to_noise : float
        Root mean square there by that of the noise (a channel) or the floor (an axis).

    """

    flight: str
    channel: str
    from_s: float
    to_s: float
    condition: str
    ratio_to_noise: float


@final
@dataclass(frozen=True, slots=True)
class PredictionGap:
    """
    How far predictions are off, one channel at one horizon.

    Attributes
    ----------
    channel : str
        'position' or 'attitude', or one of CHANNELS.
    unit : str
        Of the errors.
    horizon_s : float
        How long before the model saw the flight last. [s]
    before, tuned, after, coast, noise_floor : float
        Root mean square: the vehicle file; its tolerances fitted without any effect; with the
        named effects; body velocity and rates kept; of the measurement itself.
    shrink : float
        1 - after / before.
    shrink_ci95 : pair of float
        By bootstrap over pieces.
    pieces : int
        How many predictions there were.
    refitted : float
        Root mean square with everything fitted to forecasts, names or not; NaN where that was not
        done.

    """

    channel: str
    unit: str
    horizon_s: float
    before: float
    tuned: float
    after: float
    coast: float
    noise_floor: float
    shrink: float
    shrink_ci95: Interval
    pieces: int
    refitted: float = float('nan')


@final
class GroupShare(NamedTuple):
    """
    One name that forecasts gave.

    Attributes
    ----------
    name : str
        Of the group of knobs: 'added inertia'.
    share : float
        Part of the squared error of the vehicle file's forecasts, in regimes left out, that it
        takes away.

    """

    name: str
    share: float


@final
class LeftOutRegime(NamedTuple):
    """
    One regime, left out of the fit.

    Attributes
    ----------
    name : str
        'moving mass at 0.085 m'.
    flights : int
        How many.
    ratio : float
        Error of its forecasts with what the others taught, by that of the vehicle file.

    """

    name: str
    flights: int
    ratio: float


@final
@dataclass(frozen=True, slots=True)
class TransferEvidence:
    """
    What names given by forecasts rest on.

    Attributes
    ----------
    names : tuple of Worth
        In the order in which they were found.
    regimes : tuple of LeftOut
        The worst first.
    interpolates : tuple of str
        Names that make forecasts better where they were fitted, and did not carry over.
    numbers : int
        How many were fitted where everything was; 0 where that was not done.

    """

    names: tuple[GroupShare, ...]
    regimes: tuple[LeftOutRegime, ...]
    interpolates: tuple[str, ...] = ()
    numbers: int = 0


@final
@dataclass(frozen=True, slots=True)
class DiscoveryFinding:
    """
    All that was found.

    Attributes
    ----------
    verdict : str
        'none', 'named', 'unexplained', 'named+unexplained' or 'not_identifiable'.
    effects : tuple of NamedEffect
        The strongest first.
    ladder : tuple of tuple of Rung
        Round by round, the best candidate first.
    where : tuple of Place
        The largest first.
    gaps : tuple of Gap
        Of the held-out flights where there are any.
    held_out : bool
        Whether the gaps are of flights that nothing was fitted to.
    remains : tuple of Remainder
        What no effect of the library explains, the largest first.
    warnings : tuple of str
        One sentence each: what the data allow less than one might think.
    seed : int
        Of the bootstrap.
    bags : mapping of role to names
        'train', 'confirm', 'holdout'.
    vehicle : str
        Name of the vehicle file.
    versions : mapping of str to str
        Of the program, its commit, the registry of effects.
    next_flight : str
        What to fly or measure so that a name that is not alone becomes so; '' where all are.
    detectable : tuple of Detectable
        How small each candidate could have been and still be seen; empty where nobody asked.
    unexplained : tuple of str
        What remains, in words: 'a pitch moment that follows surge speed x yaw rate, 1.2 mN m'.
    carried : Carried, optional
        Where forecasts gave the names, and not the readings: what they rest on.
    draught : Draught, optional
        Air that moved a little by itself; nothing of the vehicle is missing for it.
    strained : tuple of str
        Knobs whose tolerance is not enough: the flights want them further off than that.

    """

    verdict: Verdict
    effects: tuple[NamedEffect, ...]
    ladder: tuple[tuple[LadderRung, ...], ...]
    where: tuple[Discrepancy, ...]
    gaps: tuple[PredictionGap, ...]
    held_out: bool
    remains: tuple[Remainder, ...]
    warnings: tuple[str, ...]
    seed: int
    bags: Mapping[str, tuple[str, ...]]
    vehicle: str
    versions: Mapping[str, str] = field(default_factory=dict)
    detectable: tuple[DetectionLimit, ...] = ()
    unexplained: tuple[str, ...] = ()
    next_flight: str = ''
    carried: TransferEvidence | None = None
    draught: DraughtFinding | None = None
    strained: tuple[str, ...] = ()
