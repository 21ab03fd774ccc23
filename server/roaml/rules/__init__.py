# SPDX-License-Identifier: Apache-2.0
"""All rules, grouped by subject. One rule is one module with one document beside it; both are named like the code.

The rules whose findings are made by parsers are in one module, `parser_rules`; their documents are in the groups as
well.
"""

from __future__ import annotations

import re
from pathlib import Path

from roaml.rules import parser_rules
from roaml.rules.answers import (
    answer_needs_time,
    invalid_status,
    repeated_answer,
    running_condition,
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
    late_event_data,
    removed_bt_event,
    unknown_event_parameter,
    unsupported_event,
)
from roaml.rules.expressions import (
    coarse_random,
    condition_not_boolean,
    division_by_zero,
    expression_syntax,
    index_out_of_bounds,
    integer_division,
    integer_range,
    invalid_location,
    invalid_operand,
    length_of_struct,
    misplaced_random,
    type_mismatch,
    unknown_function,
    unknown_member,
    unsupported_expression,
    untranslatable_script,
)
from roaml.rules.files import (
    file_too_large,
    foreign_format,
    internal_error,
    missing_file,
    missing_include,
    not_checked,
    unknown_document,
    unused_suppression,
    wrong_file_kind,
)
from roaml.rules.interfaces import (
    duplicate_field,
    duplicate_handle,
    interface_type_conflict,
    invalid_rate,
    missing_client,
    missing_feedback,
    missing_field,
    missing_server,
    repeated_interface,
    several_servers,
    silent_client,
    silent_server,
    thread_element_outside_thread,
    topic_without_publisher,
    topic_without_subscriber,
    undeclared_handle,
    unknown_field,
    unknown_ros_type,
    unset_field,
    unused_handle,
)
from roaml.rules.json_syntax import jani_type
from roaml.rules.properties import ignored_bounds, model_fault, unknown_property_variable, unsupported_property
from roaml.rules.rule import Rule
from roaml.rules.states import (
    delayed_transition,
    duplicate_state,
    event_beside_eventless,
    probability_sum,
    shadowed_branch,
    shadowed_transition,
    transition_target,
    undefined_state,
    unreachable_state,
)
from roaml.rules.systems import (
    inexact_max_time,
    input_count,
    missing_parameter,
    model_too_large,
    repeated_parameter,
    tree_too_large,
)
from roaml.rules.trees import (
    blackboard_never_read,
    blackboard_never_written,
    blackboard_read,
    blackboard_type_conflict,
    duplicate_model,
    invalid_port,
    missing_port,
    node_configuration,
    node_name,
    port_value,
    skipped_node,
    subtree_constant_written,
    tree_element_in_node,
    tree_model_mismatch,
    tree_structure,
    undeclared_port,
    unknown_plugin,
    unknown_port,
    unknown_remap,
    unused_plugin,
    unused_port,
)
from roaml.rules.variables import (
    duplicate_data,
    invalid_bounds,
    invalid_name,
    large_array_size,
    machine_name,
    missing_type,
    struct_declaration,
    undeclared_variable,
    unenforced_bounds,
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
    "properties",
    "states",
    "systems",
    "trees",
    "variables",
    "xml_syntax",
)
"""The packages that contain rules."""

RULES: tuple[Rule, ...] = (
    answer_needs_time.RULE,
    blackboard_never_read.RULE,
    blackboard_never_written.RULE,
    blackboard_read.RULE,
    blackboard_type_conflict.RULE,
    blocking_event_name.RULE,
    branch_order.RULE,
    child_count.RULE,
    coarse_random.RULE,
    condition_not_boolean.RULE,
    conflicting_value.RULE,
    delayed_transition.RULE,
    deprecated_spelling.RULE,
    division_by_zero.RULE,
    document_type.RULE,
    parser_rules.DUPLICATE_ATTRIBUTE,
    duplicate_data.RULE,
    duplicate_field.RULE,
    duplicate_handle.RULE,
    parser_rules.DUPLICATE_JSON_KEY,
    duplicate_model.RULE,
    duplicate_state.RULE,
    empty_branch.RULE,
    event_beside_eventless.RULE,
    event_data_unavailable.RULE,
    event_never_received.RULE,
    event_never_sent.RULE,
    event_type_conflict.RULE,
    expression_syntax.RULE,
    file_too_large.RULE,
    foreign_format.RULE,
    foreign_namespace.RULE,
    ignored_attribute.RULE,
    ignored_bounds.RULE,
    ignored_element.RULE,
    ignored_encoding.RULE,
    index_out_of_bounds.RULE,
    inexact_max_time.RULE,
    input_count.RULE,
    integer_division.RULE,
    integer_range.RULE,
    parser_rules.INTERFACE_SYNTAX,
    interface_type_conflict.RULE,
    internal_error.RULE,
    invalid_bounds.RULE,
    invalid_child.RULE,
    invalid_location.RULE,
    invalid_name.RULE,
    invalid_operand.RULE,
    invalid_port.RULE,
    invalid_rate.RULE,
    parser_rules.INVALID_SETTING,
    invalid_status.RULE,
    invalid_value.RULE,
    parser_rules.JANI_NAME,
    parser_rules.JANI_SYNTAX,
    jani_type.RULE,
    parser_rules.JSON_SCHEMA,
    parser_rules.JSON_SYNTAX,
    large_array_size.RULE,
    late_event_data.RULE,
    length_of_struct.RULE,
    machine_name.RULE,
    misplaced_element.RULE,
    misplaced_random.RULE,
    missing_attribute.RULE,
    missing_client.RULE,
    missing_element.RULE,
    missing_feedback.RULE,
    missing_field.RULE,
    missing_file.RULE,
    parser_rules.MISSING_FOLDER,
    missing_include.RULE,
    missing_parameter.RULE,
    missing_port.RULE,
    missing_server.RULE,
    missing_type.RULE,
    missing_value.RULE,
    model_fault.RULE,
    model_too_large.RULE,
    parser_rules.NESTING_TOO_DEEP,
    node_configuration.RULE,
    node_name.RULE,
    not_checked.RULE,
    port_value.RULE,
    probability_sum.RULE,
    removed_bt_event.RULE,
    repeated_answer.RULE,
    repeated_element.RULE,
    repeated_interface.RULE,
    repeated_parameter.RULE,
    running_condition.RULE,
    schema_violation.RULE,
    several_servers.RULE,
    shadowed_branch.RULE,
    shadowed_transition.RULE,
    silent_client.RULE,
    silent_server.RULE,
    skipped_node.RULE,
    stray_text.RULE,
    struct_declaration.RULE,
    subtree_constant_written.RULE,
    thread_element_outside_thread.RULE,
    parser_rules.TOML_SYNTAX,
    topic_without_publisher.RULE,
    topic_without_subscriber.RULE,
    transition_target.RULE,
    tree_element_in_node.RULE,
    tree_model_mismatch.RULE,
    tree_structure.RULE,
    tree_too_large.RULE,
    type_mismatch.RULE,
    unanswered_goal.RULE,
    unanswered_halt.RULE,
    unanswered_request.RULE,
    unanswered_tick.RULE,
    undeclared_handle.RULE,
    undeclared_port.RULE,
    undeclared_variable.RULE,
    undecodable_text.RULE,
    parser_rules.UNDEFINED_ENTITY,
    undefined_state.RULE,
    unenforced_bounds.RULE,
    unknown_attribute.RULE,
    unknown_document.RULE,
    unknown_element.RULE,
    unknown_event_parameter.RULE,
    unknown_field.RULE,
    unknown_function.RULE,
    unknown_member.RULE,
    unknown_plugin.RULE,
    unknown_port.RULE,
    unknown_property_variable.RULE,
    unknown_remap.RULE,
    unknown_ros_type.RULE,
    unknown_thread.RULE,
    unknown_type.RULE,
    unreachable_state.RULE,
    unset_field.RULE,
    unsupported_event.RULE,
    unsupported_expression.RULE,
    unsupported_property.RULE,
    unsupported_scxml_element.RULE,
    untranslatable_script.RULE,
    unused_handle.RULE,
    unused_plugin.RULE,
    unused_port.RULE,
    unused_suppression.RULE,
    unused_variable.RULE,
    wrong_file_kind.RULE,
    wrong_goal_id.RULE,
    parser_rules.XML_SYNTAX,
)

_FOLDER = Path(__file__).parent

BY_CODE = {rule.code: rule for rule in RULES}


def document(code: str) -> str:
    """The document of a rule (Markdown), with links relative to its file. Raises `KeyError` if there is no such
    rule."""
    return document_file(code).read_text(encoding="utf-8")


def document_file(code: str) -> Path:
    """The file of the document of a rule. Raises `KeyError` if there is no such rule."""
    rule_name = BY_CODE[code].code.replace("-", "_")
    files = (_FOLDER / group / f"{rule_name}.md" for group in GROUPS)
    return next(file for file in files if file.is_file())


def cited(text: str) -> str:
    """The document of a rule for readers outside of the repository: links to the definition become citations."""
    return _DEFINITION.sub(r"\1 (docs/spec/\2)", text)


def in_reference(text: str) -> str:
    """The document of a rule with links that are valid in docs/reference."""
    return _DEFINITION.sub(r"[\1](../spec/\2)", text)


_DEFINITION = re.compile(r"\[([^]]+)\]\((?:\.\./)+docs/spec/([^)]+)\)")
