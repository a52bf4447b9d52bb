# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""Record the readings that a draft settles, with reasons, and the questions that it cannot."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, cast, Final, final, NamedTuple, Self

from lta_config.errors import BadInput, unknown_name_error
from lta_model.vehicle import load_vehicle
import numpy as np
from pydantic import BeforeValidator

# Body axes that a lab commands, in the order of a wrench
BODY_AXES: Final = ('surge', 'sway', 'heave', 'roll', 'pitch', 'yaw')
FLOATS: Final = 0.5  # of the mass, displaced
NO_PUSH: Final = 1e-4  # N, N m; rotors do not push along an axis with less


def parse_answers(values: object) -> dict[str, str]:
    """Return the answers to questions by key, also of texts such as 'time.rate=60'."""
    if isinstance(values, Mapping):
        return dict(values)
    answers = {}
    for setting in cast('Sequence[str]', values):
        key, sign, value = setting.partition('=')
        if not sign or not key or not value:
            raise ValueError(f"'{setting}' is not KEY=VALUE, as in time.rate=60")
        answers[key] = value
    return answers


Answers = Annotated[dict[str, str], BeforeValidator(parse_answers)]


@final
class DraftVehicle(NamedTuple):
    """A vehicle that flew in a log."""

    name: str
    rotors: tuple[str, ...]  # in the order of `motors`
    largest: dict[str, float]  # force or moment by all rotors, by axis [N, N m]
    # Where they push, on average, in body axes from the hull centre, by axis of a force [m]
    centres: dict[str, tuple[float, ...]]
    floats: bool = False  # whether gas carries most of it, so that its tilt does not accelerate it

    @classmethod
    def load(cls, name: str) -> Self:
        """Return the vehicle of a name or file; raise `BadInput` if there is none."""
        vehicle = load_vehicle(name)
        largest = {
            axis: sum(abs(rotor.column[k]) * rotor.full_thrust for rotor in vehicle.rotors)
            for k, axis in enumerate(BODY_AXES)
        }
        pushed = {axis: most for axis, most in largest.items() if most > NO_PUSH}
        centres = {}
        for k, axis in enumerate(BODY_AXES[:3]):
            weights = [abs(rotor.column[k]) * rotor.full_thrust for rotor in vehicle.rotors]
            if axis in pushed:
                places = np.array([rotor.place for rotor in vehicle.rotors])
                centres[axis] = tuple(np.average(places, axis=0, weights=weights).tolist())
        floats = vehicle.displaced_mass > FLOATS * vehicle.mass
        return cls(vehicle.file.name, tuple(vehicle.rotor_names), pushed, centres, floats)


@final
class DraftReason(NamedTuple):
    """A row of the table of reasons: what, from which columns, read how, and why."""

    part: str
    columns: str
    reading: str
    reason: str


@final
class DraftQuestion(NamedTuple):
    """Interpretations that fit equally well; `options` are values with descriptions."""

    key: str
    options: Sequence[tuple[str, str]]
    reason: str
    is_open: bool = False  # the options are examples, and other answers fit too


@final
@dataclass(slots=True)
class DraftChoices:
    """The decisions of a draft."""

    answers: Mapping[str, str] = field(default_factory=dict)  # answers of the user, by key
    reasons: list[DraftReason] = field(default_factory=list)
    questions: list[DraftQuestion] = field(default_factory=list)  # those without an answer
    used: set[str] = field(default_factory=set)
    settled: dict[str, str] = field(default_factory=dict)  # by the first topic, for the others
    vehicle: DraftVehicle | None = None  # that flew
    by_motion: Mapping[str, str] = field(default_factory=dict)  # what the motion decides, by key
    follows: Mapping[str, str] = field(default_factory=dict)  # the motion of a column, a sentence

    def add_reason(self, part: str, columns: Sequence[str], reading: str, reason: str) -> None:
        """Add a row to the table of reasons."""
        self.reasons.append(DraftReason(part, ', '.join(columns), reading, reason))

    def override(self, key: str, value: str) -> str:
        """Return the user's value of a key, or the default."""
        self.used.add(key)
        return self.answers.get(key, value)

    def find_answer(self, key: str) -> str:
        """Return the value of a key that many columns have, by the user or the motion, or ''."""
        if key in self.answers:
            self.used.add(key)
        return self.answers.get(key, self.by_motion.get(key, ''))

    def decide(
        self,
        key: str,
        options: Sequence[tuple[str, str]],
        reason: str,
        *,
        is_open: bool = False,
    ) -> str:
        """
        Return the user's answer; without one, note the question and return the first option.

        `is_open`: the options are examples. Raise `BadInput` if the answer is none of them
        otherwise.
        """
        self.used.add(key)
        names = [name for name, _ in options]
        answer = self.answers.get(key)
        if answer is None:
            self.questions.append(DraftQuestion(key, options, reason, is_open))
            return names[0]
        if answer not in names and not is_open:
            raise unknown_name_error(f'answer to {key}', answer, names)
        return answer

    def explain(self, key: str) -> str:
        """Return why a reading of a question that arose was taken."""
        return 'as you decided' if key in self.answers else 'open: two readings fit'

    def refuse_unused(self) -> None:
        """Raise BadInput for an answer to a question that does not arise."""
        unused = sorted({*self.answers} - self.used)
        if unused:
            keys = ', '.join(sorted(self.used)) or 'none'
            raise BadInput(
                f'--set {unused[0]} decides nothing in this log; it has the keys {keys}.'
            )
