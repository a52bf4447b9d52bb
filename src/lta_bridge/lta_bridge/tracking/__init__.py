"""Pose and motion of the drone from an external tracker."""
