"""EXUDYN's ParameterVariation: each joint of a variant a GenericODE2 with a symbolic user function, which is compiled to no
Python, integrated by its DOPRI5 with automatic steps; naive: the contact is an IfThenElse of the state. Events are not told.
"""

import exudyn as exu
import exudyn.utilities as utilities
import variants
from exudyn.processing import ParameterVariation

import model

LADDER = ("1e-5", "1e-6")
SYMBOLIC = exu.symbolic
JOINTS = []
# Absolute tolerance over the relative one, between the scales of positions and speeds [m, m/s].
ABSOLUTE = 1e-3


def user_function(system, own, body):
    """The accelerations of a joint as a symbolic user function. EXUDYN's own conversion begins with vectors of no length, in which
    no entry can be named; so this is that conversion with vectors of three."""
    SYMBOLIC.SetRecording(True)
    t, item = SYMBOLIC.Real("t", 0.0), SYMBOLIC.Real("item", 0)
    q, v = SYMBOLIC.Vector("q", list(own.start()[:3])), SYMBOLIC.Vector("v", [0.0] * 3)
    value = SYMBOLIC.Vector(list(accelerations(own, q, v)))
    SYMBOLIC.SetRecording(False)
    recorded = {
        "functionName": "force",
        "argList": [system, t, item, q, v],
        "argTypeList": ["MainSystem", "Real", "Index", "StdVector", "StdVector"],
        "returnValue": value,
        "returnType": "StdVector",
    }
    function = SYMBOLIC.UserFunction()
    function.SetUserFunctionFromDict(system, recorded, "forceUserFunction", body, "None")
    return function


def accelerations(own, q, v):
    y = (*(q[k] for k in range(3)), *(v[k] for k in range(3)))
    if_in_contact = lambda x: SYMBOLIC.IfThenElse(model.delta(y, SYMBOLIC.sqrt, own.clearance) > 0.0, x, SYMBOLIC.Real(0.0))
    contact = (if_in_contact(SYMBOLIC.Real(own.stiffness)), if_in_contact(SYMBOLIC.Real(own.damping)), own.clearance, own.mu)
    sign = SYMBOLIC.IfThenElse(model.v_t(y, SYMBOLIC.sqrt) < 0.0, SYMBOLIC.Real(-1.0), SYMBOLIC.Real(1.0))
    return model.slope(own.joint, sign, y, SYMBOLIC.sin, SYMBOLIC.cos, SYMBOLIC.sqrt, contact)[3:]


def run(parameters):
    """Called by EXUDYN with the number of a joint and the digits of the tolerance."""
    own, rtol = JOINTS[round(parameters["joint"])], 10.0 ** -parameters["digits"]
    system = exu.SystemContainer().AddSystem()
    node = system.AddNode(utilities.NodeGenericODE2(referenceCoordinates=[0.0] * 3, initialCoordinates=own.start()[:3],
                                                    initialCoordinates_t=[0.0] * 3, numberOfODE2Coordinates=3))
    unit = [[float(i == j) for j in range(3)] for i in range(3)]
    body = system.AddObject(utilities.ObjectGenericODE2(nodeNumbers=[node], massMatrix=unit))
    function = user_function(system, own, body)
    system.SetObjectParameter(body, "forceUserFunction", function)
    system.Assemble()
    settings = exu.SimulationSettings()
    time = settings.timeIntegration
    time.endTime, time.numberOfSteps, time.initialStepSize, time.minimumStepSize = 2.0, 100, 1e-5, 1e-13
    time.relativeTolerance, time.absoluteTolerance = rtol, rtol * ABSOLUTE
    time.explicitIntegration.computeEndOfStepAccelerations = False
    settings.solutionSettings.writeSolutionToFile = False
    system.SolveDynamic(settings, solverType=exu.DynamicSolverType.DOPRI5)
    return [float(x) for x in system.GetNodeOutput(node, exu.OutputVariableType.Coordinates)]


def solve(digits, workers):
    n = len(JOINTS)
    parameters = {"joint": (0, n - 1, n), "digits": (digits, digits, 1)}
    _, values = ParameterVariation(run, parameters, useMultiProcessing=workers > 1, numberOfThreads=workers, showProgress=False)
    return variants.Ends(list(zip(values[: n // 2], values[n // 2 :])), [])


def settings(_, all_variants, workers):
    # Words of each run are no part of it.
    exu.SetWriteToConsole(False)
    exu.SuppressWarnings(True)
    JOINTS[:] = [own[j] for j in (0, 1) for own in all_variants]
    for rtol in LADDER:
        digits = float(rtol.split("-")[1])
        yield ("EXUDYN", exu.config.Version(), "DOPRI5", f"rtol {rtol}"), 0.0, lambda digits=digits: solve(digits, workers)
