"""Score readings of a log by kinematics, for the draft of an import and the check of a bag."""
