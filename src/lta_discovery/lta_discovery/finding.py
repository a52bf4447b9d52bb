"""Define the result of a study as plain data, from which JSON, page and vehicle file derive."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final, final, Literal, NamedTuple

from lta_config.schema.vehicle_law import Law
from lta_discovery.calibration.result import Calibration
from lta_discovery.selection.detection_limit import DetectionLimit
from lta_discovery.unmodeled.draught import DraughtEstimate
from lta_discovery.unmodeled.unexplained_force import Remainder

Verdict = Literal['none', 'named', 'unexplained', 'named+unexplained', 'not_identifiable']
Interval = tuple[float, float]

SCHEMA: Final = 1  # of discovery.json


@final
class ParameterEstimate(NamedTuple):
    """Estimate of one parameter of an effect."""

    name: str  # within the effect
    unit: str  # SI; '1' for a pure number
    before: float  # value in the vehicle file; the null value where the effect was off
    value: float  # maximum a posteriori estimate from all training and confirming flights
    ci95: Interval
    in_file: bool = True  # whether the vehicle file has the effect at all


@final
class SearchCandidate(NamedTuple):
    """One candidate in one round of the effect search."""

    knob: str  # the candidate: 'linear_drag.surge', or a generic rival
    # Gain in log evidence on the training flights; on the confirming flights alone; and on the
    # confirming flights with the values learned from the training flights [nats]
    train: float
    confirm: float
    carried: float
    apart: float  # difference between the two estimates, in standard deviations
    accepted: bool  # whether the search accepted it

    @property
    def total(self) -> float:
        """Evidence that counts: training flights plus the larger confirmation. [nats]"""
        return self.train + max(self.confirm, self.carried)


@final
class AssumedValue(NamedTuple):
    """A parameter of an effect that was assumed, not fitted."""

    # Within the effect; SI
    name: str
    unit: str
    value: float


@final
@dataclass(frozen=True, slots=True)
class NamedEffect:
    """An effect that the vehicle file lacks."""

    name: str  # in the registry of effects
    knobs: tuple[str, ...]  # its named parameters, in the order in which they were accepted
    parameters: tuple[ParameterEstimate, ...]
    # Evidence lost on all training and confirming flights without the effect [nats]
    log_evidence: float
    # Parameters that these flights cannot distinguish from it
    confusable_with: tuple[str, ...] = ()
    # Parameters that are neither in the vehicle file nor fitted. `parameters` depend on them; the
    # intervals do not include their uncertainty
    assumed: tuple[AssumedValue, ...] = ()


@final
class Discrepancy(NamedTuple):
    """Where and when the model of the vehicle file disagrees with a flight."""

    flight: str  # name of the bag
    channel: str  # of CHANNELS, or an axis of the wrench: 'surge' to 'yaw'
    # Since the start of the flight [s]
    from_s: float
    to_s: float
    # Condition under which it occurs: 'always', 'airspeed above 0.4 m/s', 'after 43 s'
    condition: str
    ratio_to_noise: float  # RMS error by the RMS noise (a channel) or by the noise floor (an axis)


@final
@dataclass(frozen=True, slots=True)
class ChannelErrors:
    """Prediction errors of one channel at one horizon."""

    channel: str  # 'position' or 'attitude', or one of CHANNELS
    unit: str
    horizon_s: float  # time since the model was last set to a measured state [s]
    # Root mean square error of: the vehicle file; the file with fitted tolerances and no new
    # effect; the file with the named effects; constant body velocity and rates; the measurement
    # itself
    before: float
    tuned: float
    after: float
    coast: float
    noise_floor: float
    shrink: float  # 1 - after / before
    shrink_ci95: Interval  # by bootstrap over pieces
    pieces: int
    # Root mean square error with all parameters fitted to forecasts; NaN where that was not done
    refitted: float = float('nan')
    # 95 % interval of 1 - after / tuned, by bootstrap over pieces: what the named effects add
    added_ci95: Interval = (float('nan'), float('nan'))


@final
class IdentifiedGroup(NamedTuple):
    """A parameter group that forecasts identified."""

    name: str  # of the group: 'added inertia'
    # Part of the squared forecast error of the vehicle file, in left-out regimes, that it removes
    share: float


@final
class FlightShare(NamedTuple):
    """Share of a flight in what all flights tell about a number."""

    flight: str
    share: float


@final
class InformedParameter(NamedTuple):
    """A number that some flights inform."""

    knob: str  # the free parameter
    remaining: float  # its standard deviation after the flights, by that before
    flights: tuple[FlightShare, ...]  # the most informative first


@final
class LeftOutRegime(NamedTuple):
    """Forecast error of one flight regime that was left out of the fit."""

    name: str  # 'moving mass at 0.085 m'
    flights: int
    # Forecast error with the values learned from the other regimes, by that of the vehicle file
    ratio: float


@final
class LeftOutKind(NamedTuple):
    """Forecast errors of the pieces of one kind (slow, fast, straight, turning) without them."""

    name: str  # 'slower than 0.54 m/s'
    # Error with the values learned from the other pieces, by that of the vehicle file
    position: float
    attitude: float


@final
@dataclass(frozen=True, slots=True)
class TransferEvidence:
    """Evidence of forecasts: for the effects that they identified, or for a refit alone."""

    names: tuple[IdentifiedGroup, ...]  # in the order of selection; none if only all was refitted
    # Regimes left out of the fit of the names, or of everything; the worst first
    regimes: tuple[LeftOutRegime, ...]
    # Groups that improve forecasts only in the regimes that they were fitted to
    interpolates: tuple[str, ...] = ()
    numbers: int = 0  # number of parameters in the fit of everything; 0 where that was not done
    # Effects that make forecasts worse in flight of another kind, with the reason
    rejected: tuple[str, ...] = ()
    # Errors in flight of another kind; empty where the flights are all of one kind
    kinds: tuple[LeftOutKind, ...] = ()


@final
class FittedTolerance(NamedTuple):
    """A value of the vehicle file that was fitted together with a law."""

    name: str  # in words
    unit: str
    change: float  # from the vehicle file, in its unit; '1' is relative
    deviations: float  # the same in standard deviations of its tolerance


@final
@dataclass(frozen=True, slots=True)
class LawFinding:
    """A law for the unexplained force, or why there is none."""

    law: Law | None
    reason: str = ''  # why no law is proposed
    # On the held-out flights, position and attitude: `before` with the vehicle file, `tuned` with
    # the model without the law, `after` with the law
    errors: tuple[ChannelErrors, ...] = ()
    near: tuple[str, ...] = ()  # the nearest library effects, and why they are rejected
    tried: Law | None = None  # also if it is not proposed
    # Text of the vehicle file with the law, and what else changed in it; with a proposed law only
    file: str = ''
    tolerances: tuple[FittedTolerance, ...] = ()


@final
@dataclass(frozen=True, slots=True)
class StudyResult:
    """The result of a study."""

    verdict: Verdict  # of the search; what is said of it, `conclusion.py` decides
    effects: tuple[NamedEffect, ...]  # the strongest first
    # Rounds of the search, the best candidate first
    ladder: tuple[tuple[SearchCandidate, ...], ...]
    where: tuple[Discrepancy, ...]  # the largest first
    gaps: tuple[ChannelErrors, ...]  # of the held-out flights where there are any
    held_out: bool  # whether the gaps are of flights that nothing was fitted to
    # Forces that no effect of the library explains, the largest first
    remains: tuple[Remainder, ...]
    warnings: tuple[str, ...]  # limits of the data, one sentence each
    seed: int  # of the bootstrap
    bags: Mapping[str, tuple[str, ...]]  # 'train', 'confirm', 'holdout'
    vehicle: str  # name of the vehicle file
    # Of the program, its commit, the registry of effects
    versions: Mapping[str, str] = field(default_factory=dict)
    # Smallest detectable size of each candidate; empty where not requested
    detectable: tuple[DetectionLimit, ...] = ()
    # Remainders in words: 'a pitch moment that varies with surge speed x yaw rate, 1.2 mN m'
    unexplained: tuple[str, ...] = ()
    # What to fly or measure to resolve confusable names; '' if there are none
    next_flight: str = ''
    # Evidence where forecasts, not the sensor readings, identified the effects
    carried: TransferEvidence | None = None
    # Slow air motion in the room; not a defect of the vehicle file
    draught: DraughtEstimate | None = None
    # Parameters that the flights want further off than their tolerance allows
    strained: tuple[str, ...] = ()
    offsets: tuple[str, ...] = ()  # calibration numbers far from the vehicle file, one clause each
    training: tuple[ChannelErrors, ...] = ()  # of position and attitude, on the flights of the fit
    # Which flight informs which number, the best known first
    information: tuple[InformedParameter, ...] = ()
    # Of the vehicle before the search, if the flights called for one. What the other attributes
    # call the vehicle file is then the calibrated one.
    calibration: Calibration | None = None
    # Sought only if something outside the library is at work
    law: LawFinding | None = None
