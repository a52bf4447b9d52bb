# Copyright 2026 The LTA maintainers
# SPDX-License-Identifier: Apache-2.0
"""
Virtual wind tunnel: compute a vehicle's drag and rotor wrenches from its shape.

Pipeline: shape, mesh, sweep, fit, `<vehicle>.aero.yaml`. `analytic` has the estimates by hand.
OpenFOAM solves the flow; `openfoam.case` runs its programs as separate processes.
"""
