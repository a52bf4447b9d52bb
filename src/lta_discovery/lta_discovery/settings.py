# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Everything that decides what is calibrated, found, named and advised: priors and limits.

How far numbers of a vehicle file may be off is in `model.parameters` and
`model.calibration_parameters`; how fits and filters converge, beside their equations.
"""

import math
from typing import Final

# Prior of what may be present. Sizes are standard deviations, each as likely as the others
EFFECT_SIZES: Final = (0.1, 0.3, 1.0, 3.0, 10.0)  # typical sizes of an effect
NUMBER_SIZES: Final = (3.0, 10.0, 30.0)  # tolerances of a number of the file that is wrong
FORCE_SIZES: Final = (3.0, 10.0, 40.0)  # noise floors of a force of another form
EXPECTED_EFFECTS: Final = 1.0  # effects that are missing, on average
EXPECTED_NUMBERS: Final = 0.5  # numbers of the file that are wrong, on average
EXPECTED_FORCES: Final = 0.5  # forces of another form, on average
# Factor on all tolerances of the file, and its probability. A file that is further off is
# calibrated first; with more freedom, real flights led far from any vehicle
TRUST: Final = {1.0: 0.75, 3.0: 0.25}
# Noise floors at which the unexplained wrench is capped in further looks: what is missing raises
# it, and a raised one hides what is missing
CAPPED_NOISE_FLOORS: Final = (2.5, 1.0)

# Search
BEAM_WIDTH: Final = 4  # models that are extended
LARGEST_MODEL: Final = 12  # elements of a model
# Elements that a model may gain before the flights are linearized about it: far from the truth a
# linear model asks for many elements, of which few remain
GROWTH: Final = 2
ADDED: Final = 10  # additions to a model that are tried, the most promising first
MOST_SWAPS: Final = 5  # the same in place of another element
HOPELESS: Final = 12.0  # nats below the best; such a model is not looked at more closely
MOST_SEARCH_STEPS: Final = 12  # from one model to a better one, most

# Conclusion
CERTAIN: Final = 0.95  # probability among the models from which on something is named
# Nats by which a fit without a name has to be less probable: by a factor of 100, as at most one
# name in a hundred is to be wrong. Of 22 simulated cases with known answers, with a factor of 10,
# 100 or 10,000 in its place, 6, 6 or 5 of 7 single effects of 4 to 40 standard deviations were
# named, and nothing wrong. The nats are divided by the square of `ParameterFit.excess`
LEAST_GAIN: Final = math.log(100.0)
# Typical sizes of an effect; a smaller one is taken for an error of the model, as of a drag beside
# a strong wind
NEGLIGIBLE: Final = 0.02
ALIKE: Final = 0.95  # cosine of two columns beside the rest of the model; beyond it, one class
UNEXPLAINED: Final = 2.5  # noise floors of an unexplained wrench from which on it is reported

# Calibration of a vehicle file
LEARNED_SHARE: Final = 0.7  # of the deviation before; a value with a larger one was not learned
ALIKE_CORRELATION: Final = 0.85  # correlation; values above it cannot be separated
# Standard deviations, or tolerances; a value further from the file, or from that of another
# flight, is clearly different
CLEAR: Final = 3.0
# Of the forecast error of a fit to all readings; a fit to the forecasts themselves needs less, as
# it follows the noise in them
FORECAST_FIT_RATIO: Final = 0.9
# The same; below it, the fit to all readings has strayed, and begins again where the other ends:
# 0.37 where it did, 0.70 to 0.97 on real flights
STRAYED: Final = 0.5
# Nats; by which another heading of the markers than the file's has to be more probable. Half a
# turn with rotors that push backwards is nearly the same vehicle: in pairs of real flights it was
# 27 nats more to 11 less probable, a quarter of a turn 700 less
HEADING_EVIDENCE: Final = 100.0
# Tolerances; what a first look finds further off gets a wider assumption, which must not hold it
# back: any heading of the markers [rad], or a factor on the tolerances of the pendulum
ASSUMED_TOLERANCE: Final = 2.0
ANY_HEADING: Final = 1.6
WIDER: Final = 2.0
# Of the position error of a file; another file with more is not advised, and a calibration with
# more on confirming flights is contradicted
WORSE: Final = 1.05

# Calibration as the first step of a discovery
# Differences from the vehicle file that call for it, by the beginning of the name
CALLS: Final = {
    'wrench_gain': 0.4,
    'rotor_': 0.5,  # relative; less may be a fault that discovery names
    'marker_offset.x': 0.025,  # m
    'marker_offset.y': 0.025,
    'marker_offset.z': 0.025,
    'marker_offset': 0.035,  # rad
    'command_delay': 0.2,  # s; less may be an effect that discovery names
    # Relative; the mass is not fitted well enough
    **{f'vehicle.{axis}': 0.25 for axis in ('roll', 'pitch', 'yaw')},
}
LIFT_GAP: Final = 0.005  # N; difference between the net lifts of two flights
MAYBE: Final = 0.7  # of a difference; a linear fit may underestimate it
USELESS: Final = 0.9  # of the error of coasting; a file with a larger one predicts nothing
POOR: Final = 0.5  # of the error of coasting; a file with a larger one predicts poorly
MUCH: Final = 0.7  # of the position error of such a file; a calibration needs less
# Of the file's forecast error; a calibration needs less, by its method. Where a fit to all
# readings forecasts poorly, something that the model lacks looks like a turned marker
ERROR_RATIOS: Final = {'likelihood': 0.8, 'forecasts': 0.3, 'file': 0.0}
