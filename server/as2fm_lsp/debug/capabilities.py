# SPDX-License-Identifier: Apache-2.0
"""The capabilities of the adapter: the answer to `initialize`."""

from __future__ import annotations

from typing import Any

from roaml.debugging.breakpoints import ExceptionFilter

_FILTERS = {
    ExceptionFilter.VIOLATED: ("A property is violated", "A property is decided, and does not hold in this run", True),
    ExceptionFilter.SATISFIED: ("A property is satisfied", "A property is decided, and holds in this run", False),
    ExceptionFilter.FAILURE: ("A node fails", "A node of the behavior tree returns FAILURE", False),
    ExceptionFilter.CHANCE: ("Chance decides", "The next step is drawn by probabilities of the model", False),
    ExceptionFilter.TIME: ("Time passes", "The time of the model has advanced", False),
}

CAPABILITIES: dict[str, Any] = {
    "supportsConfigurationDoneRequest": True,
    "supportsFunctionBreakpoints": True,
    "supportsConditionalBreakpoints": True,
    "supportsHitConditionalBreakpoints": True,
    "supportsEvaluateForHovers": True,
    "supportsStepBack": True,
    "supportsSetVariable": True,
    "supportsSetExpression": True,
    "supportsCompletionsRequest": True,
    "completionTriggerCharacters": [" ", "/"],
    "supportsRestartFrame": True,
    "supportsRestartRequest": True,
    "supportsExceptionInfoRequest": True,
    "supportTerminateDebuggee": True,
    "supportsDelayedStackTraceLoading": True,
    "supportsLoadedSourcesRequest": True,
    "supportsLogPoints": True,
    "supportsTerminateRequest": True,
    "supportsDataBreakpoints": True,
    "supportsCancelRequest": True,
    "supportsBreakpointLocationsRequest": True,
    "supportsExceptionFilterOptions": True,
    "exceptionBreakpointFilters": [
        {
            "filter": filter_.value,
            "label": label,
            "description": description,
            "default": is_default,
            "supportsCondition": True,
            "conditionDescription": "an expression, such as `Arm.holding == false`",
        }
        for filter_, (label, description, is_default) in _FILTERS.items()
    ],
}
