"""Everything that decides in the search for what a vehicle file lacks: priors and limits."""

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
# named, and nothing wrong
LEAST_GAIN: Final = math.log(100.0)
# Typical sizes of an effect; a smaller one is taken for an error of the model, as of a drag beside
# a strong wind
NEGLIGIBLE: Final = 0.02
ALIKE: Final = 0.95  # cosine of two columns beside the rest of the model; beyond it, one class
UNEXPLAINED: Final = 2.5  # noise floors of an unexplained wrench from which on it is reported
