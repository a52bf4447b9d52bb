"""Define the result of a study as plain data, from which JSON, page and vehicle file derive."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final, Literal, NamedTuple

from lta_discovery.calibration.result import Calibration
from lta_discovery.selection.detection_limit import DetectionLimit
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.unexplained_force import Remainder

Verdict = Literal['none', 'named', 'unexplained', 'named+unexplained', 'not_identifiable']
Interval = tuple[float, float]

SCHEMA: Final = 1  # of discovery.json


@final
class ParameterEstimate(NamedTuple):
    """
    Estimate of one parameter of an effect.

    Attributes
    ----------
    name : str
        Within the effect.
    unit : str
        SI; '1' for a pure number.
    before : float
        Value in the vehicle file; the null value where the effect was off.
    value : float
        Maximum a posteriori estimate from all training and confirming flights.
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
class SearchCandidate(NamedTuple):
    """
    One candidate in one round of the effect search.

    Attributes
    ----------
    knob : str
        The candidate: 'linear_drag.surge', or a generic rival.
    train, confirm, carried : float
        Gain in log evidence on the training flights; on the confirming flights alone; and on the
        confirming flights with the values learned from the training flights. [nats]
    apart : float
        Difference between the two estimates, in standard deviations.
    accepted : bool
        Whether the search accepted it.

    """

    knob: str
    train: float
    confirm: float
    carried: float
    apart: float
    accepted: bool

    @property
    def total(self) -> float:
        """Evidence that counts: training flights plus the larger confirmation. [nats]"""
        return self.train + max(self.confirm, self.carried)


@final
class AssumedValue(NamedTuple):
    """
    A parameter of an effect that was assumed, not fitted.

    Attributes
    ----------
    name, unit : str, str
        Within the effect; SI.

    """

    name: str
    unit: str
    value: float


@final
@dataclass(frozen=True, slots=True)
class NamedEffect:
    """
    An effect that the vehicle file lacks.

    Attributes
    ----------
    name : str
        In the registry of effects.
    knobs : tuple of str
        Its named parameters, in the order in which they were accepted.
    log_evidence : float
        Evidence lost on all training and confirming flights without the effect. [nats]
    confusable_with : tuple of str
        Parameters that these flights cannot distinguish from it.
    assumed : tuple of AssumedValue
        Parameters that are neither in the vehicle file nor fitted. `parameters` depend on them;
        the intervals do not include their uncertainty.

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
    Where and when the model of the vehicle file disagrees with a flight.

    Attributes
    ----------
    flight : str
        Name of the bag.
    channel : str
        Of CHANNELS, or an axis of the wrench: 'surge' to 'yaw'.
    from_s, to_s : float
        Since the start of the flight. [s]
    condition : str
        Condition under which it occurs: 'always', 'airspeed above 0.4 m/s', 'after 43 s'.
    ratio_to_noise : float
        RMS error by the RMS noise (a channel) or by the noise floor (an axis).

    """

    flight: str
    channel: str
    from_s: float
    to_s: float
    condition: str
    ratio_to_noise: float


@final
@dataclass(frozen=True, slots=True)
class ChannelErrors:
    """
    Prediction errors of one channel at one horizon.

    Attributes
    ----------
    channel : str
        'position' or 'attitude', or one of CHANNELS.
    horizon_s : float
        Time since the model was last set to a measured state. [s]
    before, tuned, after, coast, noise_floor : float
        Root mean square error of: the vehicle file; the file with fitted tolerances and no new
        effect;
        the file with the named effects; constant body velocity and rates; the measurement itself.
    shrink : float
        1 - after / before.
    shrink_ci95 : pair of float
        By bootstrap over pieces.
    refitted : float
        Root mean square error with all parameters fitted to forecasts; NaN where that was not
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
class IdentifiedGroup(NamedTuple):
    """
    A parameter group that forecasts identified.

    Attributes
    ----------
    name : str
        Of the group: 'added inertia'.
    share : float
        Part of the squared forecast error of the vehicle file, in left-out regimes, that it
        removes.

    """

    name: str
    share: float


@final
class FlightShare(NamedTuple):
    """Share of a flight in what all flights tell about a number."""

    flight: str
    share: float


@final
class InformedParameter(NamedTuple):
    """
    A number that some flights inform.

    Attributes
    ----------
    knob : str
        The free parameter.
    remaining : float
        Its standard deviation after the flights, by that before.
    flights : tuple of FlightShare
        The most informative first.

    """

    knob: str
    remaining: float
    flights: tuple[FlightShare, ...]


@final
class LeftOutRegime(NamedTuple):
    """
    Forecast error of one flight regime that was left out of the fit.

    Attributes
    ----------
    name : str
        'moving mass at 0.085 m'.
    ratio : float
        Forecast error with the values learned from the other regimes, by that of the vehicle file.

    """

    name: str
    flights: int
    ratio: float


@final
class LeftOutKind(NamedTuple):
    """
    Forecast errors of the pieces of one kind (slow, fast, straight, turning) without them.

    Attributes
    ----------
    name : str
        'slower than 0.54 m/s'.
    position, attitude : float
        Error with the values learned from the other pieces, by that of the vehicle file.

    """

    name: str
    position: float
    attitude: float


@final
@dataclass(frozen=True, slots=True)
class TransferEvidence:
    """
    Evidence for effects that forecasts identified.

    Attributes
    ----------
    names : tuple of IdentifiedGroup
        In the order of selection.
    regimes : tuple of LeftOutRegime
        The worst first.
    interpolates : tuple of str
        Groups that improve forecasts only in the regimes that they were fitted to.
    numbers : int
        Number of parameters in the fit of everything; 0 where that was not done.
    rejected : tuple of str
        Effects that make forecasts worse in flight of another kind, with the reason.
    kinds : tuple of LeftOutKind
        Errors in flight of another kind; empty where the flights are all of one kind.

    """

    names: tuple[IdentifiedGroup, ...]
    regimes: tuple[LeftOutRegime, ...]
    interpolates: tuple[str, ...] = ()
    numbers: int = 0
    rejected: tuple[str, ...] = ()
    kinds: tuple[LeftOutKind, ...] = ()


@final
@dataclass(frozen=True, slots=True)
class StudyResult:
    """
    The result of a study.

    Attributes
    ----------
    verdict : str
        'none', 'named', 'unexplained', 'named+unexplained' or 'not_identifiable'.
    effects : tuple of NamedEffect
        The strongest first.
    ladder : tuple of tuple of SearchCandidate
        Rounds of the search, the best candidate first.
    where : tuple of Discrepancy
        The largest first.
    gaps : tuple of ChannelErrors
        Of the held-out flights where there are any.
    held_out : bool
        Whether the gaps are of flights that nothing was fitted to.
    remains : tuple of Remainder
        Forces that no effect of the library explains, the largest first.
    warnings : tuple of str
        Limits of the data, one sentence each.
    seed : int
        Of the bootstrap.
    bags : mapping of role to names
        'train', 'confirm', 'holdout'.
    vehicle : str
        Name of the vehicle file.
    versions : mapping of str to str
        Of the program, its commit, the registry of effects.
    next_flight : str
        What to fly or measure to resolve confusable names; '' if there are none.
    detectable : tuple of DetectionLimit
        Smallest detectable size of each candidate; empty where not requested.
    unexplained : tuple of str
        Remainders in words: 'a pitch moment that varies with surge speed x yaw rate, 1.2 mN m'.
    carried : TransferEvidence, optional
        Evidence where forecasts, not the sensor readings, identified the effects.
    draught : DraughtEstimate, optional
        Slow air motion in the room; not a defect of the vehicle file.
    strained : tuple of str
        Parameters that the flights want further off than their tolerance allows.
    offsets : tuple of str
        Calibration numbers far from the vehicle file, one clause each.
    training : tuple of ChannelErrors
        Of position and attitude, on the flights of the fit.
    information : tuple of InformedParameter
        Which flight informs which number, the best known first.
    calibration : Calibration, optional
        Of the vehicle before the search, if the flights called for one. What the other attributes
        call the vehicle file is then the calibrated one.

    """

    verdict: Verdict
    effects: tuple[NamedEffect, ...]
    ladder: tuple[tuple[SearchCandidate, ...], ...]
    where: tuple[Discrepancy, ...]
    gaps: tuple[ChannelErrors, ...]
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
    draught: DraughtEstimate | None = None
    strained: tuple[str, ...] = ()
    offsets: tuple[str, ...] = ()
    training: tuple[ChannelErrors, ...] = ()
    information: tuple[InformedParameter, ...] = ()
    calibration: Calibration | None = None
