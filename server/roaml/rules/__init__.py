# SPDX-License-Identifier: Apache-2.0
"""All rules, grouped by subject. One rule is one module with one document beside it; both are named like the code.

The rules whose findings come from parsers are in one module, `parser_rules`, and those whose findings come from linking
properties in `property_rules`, and those whose findings come from the expansion of parameters and instances in
`expansion_rules`; their documents are in the groups as well. Importing a module below registers its rule.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType

from roaml.regex import regex
from roaml.rules import expansion_rules, parser_rules, property_rules
from roaml.rules.answers import (
    answer_needs_time,
    answer_never_requested,
    cancel_without_goal,
    contradictory_outcome,
    discarded_answer,
    early_status,
    endless_node,
    invalid_status,
    outstanding_response,
    repeated_answer,
    running_condition,
    unanswered_cancel,
    unanswered_goal,
    unanswered_halt,
    unanswered_request,
    unanswered_tick,
    unknown_thread,
    wrong_goal_id,
)
from roaml.rules.elements import (
    branch_order,
    child_count,
    conflicting_value,
    deprecated_spelling,
    empty_branch,
    ignored_attribute,
    ignored_element,
    invalid_child,
    invalid_value,
    misplaced_element,
    missing_attribute,
    missing_element,
    missing_value,
    not_in_reference,
    repeated_element,
    schema_violation,
    unknown_attribute,
    unknown_element,
    unsupported_scxml_element,
)
from roaml.rules.events import (
    blocking_event_name,
    event_data_unavailable,
    event_never_received,
    event_never_sent,
    event_type_conflict,
    handler_without_effect,
    late_event_data,
    removed_bt_event,
    unexpected_value,
    unhandled_value,
    unknown_event_parameter,
    unsupported_event,
)
from roaml.rules.expressions import (
    coarse_random,
    condition_not_boolean,
    constant_expression,
    division_by_zero,
    expression_syntax,
    inconsistent_operator,
    index_out_of_bounds,
    integer_division,
    integer_range,
    invalid_location,
    invalid_operand,
    length_of_struct,
    misplaced_random,
    real_equality,
    repeated_comparison,
    repeated_operand,
    type_mismatch,
    unknown_function,
    unknown_member,
    unsupported_expression,
    wrong_limit,
)
from roaml.rules.files import (
    file_too_large,
    foreign_format,
    internal_error,
    missing_file,
    missing_include,
    not_checked,
    unknown_document,
    unlisted_file,
    unused_suppression,
    wrong_file_kind,
)
from roaml.rules.interfaces import (
    cancel_never_sent,
    constant_message,
    duplicate_field,
    duplicate_handle,
    interface_type_conflict,
    invalid_rate,
    misleading_handle,
    missing_client,
    missing_feedback,
    missing_field,
    missing_server,
    repeated_interface,
    repeated_subscription,
    several_servers,
    silent_client,
    silent_server,
    thread_element_outside_thread,
    topic_without_publisher,
    topic_without_subscriber,
    undeclared_handle,
    unhandled_cancel,
    unhandled_canceled_result,
    unknown_field,
    unknown_ros_type,
    unset_field,
    unused_handle,
)
from roaml.rules.json_syntax import jani_type
from roaml.rules.properties import (
    contradictory_name,
    decided_at_start,
    equal_ports,
    ignored_bounds,
    model_fault,
    never_satisfied,
    repeated_property_id,
    unknown_property_variable,
    unmet_expectation,
    unportable_expectation,
    unsupported_property,
    vacuous_expectation,
    vacuous_property,
)
from roaml.rules.rule import Rule
from roaml.rules.states import (
    asymmetric_parts,
    constant_condition,
    delayed_transition,
    duplicate_state,
    equal_branches,
    event_beside_eventless,
    never_taken,
    probability_sum,
    reversed_limits,
    shadowed_branch,
    shadowed_transition,
    time_stops,
    transition_target,
    trapping_state,
    undefined_state,
    unreachable_state,
)
from roaml.rules.systems import (
    beyond_max_time,
    inconsistent_value,
    inexact_max_time,
    input_count,
    lost_messages,
    missing_parameter,
    model_too_large,
    repeated_parameter,
    short_time,
    small_clock_step,
    timer_rate,
    timer_step,
    tree_too_large,
)
from roaml.rules.trees import (
    blackboard_never_read,
    blackboard_never_written,
    blackboard_read,
    blackboard_type_conflict,
    duplicate_model,
    early_read,
    hidden_failure,
    inconsistent_branch,
    invalid_port,
    late_condition,
    missing_else,
    missing_inverter,
    missing_port,
    mixed_entries,
    never_in_time,
    never_succeeds,
    never_ticked,
    node_configuration,
    node_kind,
    node_model,
    node_name,
    port_range,
    port_value,
    redundant_decorator,
    restarted_node,
    script_name,
    script_syntax,
    script_type,
    skipped_condition,
    subtree_constant_written,
    tree_element_in_node,
    tree_format,
    tree_name,
    tree_semantics,
    tree_structure,
    unchanged_entry,
    undeclared_port,
    unknown_node,
    unknown_port,
    unknown_remap,
    unreached_node,
    unrepeated_rate,
    unset_output,
    untranslatable_tree,
    unused_plugin,
    unused_port,
    unused_tree,
    wrong_error_code,
)
from roaml.rules.variables import (
    constant_variable,
    copied_value,
    duplicate_data,
    equal_constants,
    inconsistent_constant,
    invalid_bounds,
    invalid_name,
    large_array_size,
    machine_name,
    misplaced_value,
    missing_type,
    mixed_names,
    never_reset,
    overwritten_value,
    self_assignment,
    sent_too_early,
    struct_declaration,
    undeclared_variable,
    unenforced_bounds,
    unguarded_read,
    unknown_type,
    unused_variable,
)
from roaml.rules.xml_syntax import document_type, foreign_namespace, ignored_encoding, stray_text, undecodable_text

GROUPS = (
    "answers",
    "elements",
    "events",
    "expressions",
    "files",
    "interfaces",
    "json_syntax",
    "parameters",
    "properties",
    "states",
    "systems",
    "trees",
    "variables",
    "xml_syntax",
)
"""The packages that contain rules."""

_MODULES = [value for value in globals().values() if isinstance(value, ModuleType) and hasattr(value, "RULE")]

RULES: tuple[Rule, ...] = tuple(
    sorted(
        (
            *(module.RULE for module in _MODULES),
            *expansion_rules.RULES,
            *parser_rules.RULES,
            *property_rules.RULES,
        ),
        key=lambda rule: rule.code,
    )
)
"""All rules, sorted by code: those of the modules that are imported above."""

_FOLDER = Path(__file__).parent

BY_CODE = {rule.code: rule for rule in RULES}


def document(code: str) -> str:
    """The document of a rule (Markdown), with links relative to its file. Raises `KeyError` for unknown codes."""
    return document_file(code).read_text(encoding="utf-8")


def document_file(code: str) -> Path:
    """The file of the document of a rule. Raises `KeyError` for unknown codes."""
    rule_name = BY_CODE[code].code.replace("-", "_")
    files = (_FOLDER / group / f"{rule_name}.md" for group in GROUPS)
    return next(file for file in files if file.is_file())


def cited(text: str) -> str:
    """The document of a rule for readers outside of the repository: links to the definition become citations."""
    return _DEFINITION.sub(r"\1 (docs/spec/\2)", text)


def in_reference(text: str) -> str:
    """The document of a rule with links that are valid in docs/reference."""
    return _DEFINITION.sub(r"[\1](../spec/\2)", text)


_DEFINITION = regex(r"\[([^]]+)\]\((?:\.\./)+docs/spec/([^)]+)\)")
