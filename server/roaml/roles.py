# SPDX-License-Identifier: Apache-2.0
"""The closed vocabularies of the roles that the schemas assign to elements and attributes (`xs:appinfo`,
urn:roaml:roles).

Each value that a schema uses is a member here; `tests/language/test_roles.py` checks this.
"""

from __future__ import annotations

from roaml.exhaustive import Vocabulary


class RoleValue(Vocabulary):
    """A value of a role, as written in the schemas."""


class SymbolKind(RoleValue):
    """The kind of a symbol. Values of attributes define or name symbols of most kinds. No attribute defines or names
    symbols of the kinds in `ELSEWHERE`, which only features of the editor use."""

    ACTION = "action"
    ACTION_CLIENT = "action-client"
    ACTION_SERVER = "action-server"
    EVENT = "event"
    FIELD = "field"
    MACHINE = "machine"
    MEMBER = "member"
    MODEL_PARAMETER = "model-parameter"
    PARAMETER = "parameter"
    PLUGIN = "plugin"
    PORT = "port"
    PORT_VARIABLE = "port-variable"
    PROPERTY = "property"
    PUBLISHER = "publisher"
    SERVICE = "service"
    SERVICE_CLIENT = "service-client"
    SERVICE_SERVER = "service-server"
    STATE = "state"
    STRUCT = "struct"
    SUBSCRIBER = "subscriber"
    TIMER = "timer"
    TOPIC = "topic"
    TREE = "tree"
    TREE_NODE = "tree-node"
    VARIABLE = "variable"

    # The kinds in `ELSEWHERE`, which no schema uses.
    ATTRIBUTE = "attribute"
    BASE_TYPE = "base-type"
    BLACKBOARD = "blackboard"
    ELEMENT = "element"
    ENUMERATION_VALUE = "enumeration-value"
    EVENT_VARIABLE = "event-variable"
    FUNCTION = "function"
    GLOBAL = "global"
    JSON = "json"
    ROS_TYPE = "ros-type"
    TREE_INSTANCE = "tree-instance"


ELSEWHERE = frozenset(
    (
        SymbolKind.ATTRIBUTE,
        SymbolKind.BASE_TYPE,
        SymbolKind.BLACKBOARD,
        SymbolKind.ELEMENT,
        SymbolKind.ENUMERATION_VALUE,
        SymbolKind.EVENT_VARIABLE,
        SymbolKind.FUNCTION,
        SymbolKind.GLOBAL,
        SymbolKind.JSON,
        SymbolKind.ROS_TYPE,
        SymbolKind.TREE_INSTANCE,
    )
)
"""The kinds that no schema uses: parts of the languages themselves, ROS types, names on the blackboard, nodes of the
executed tree, and variables of the translation."""


class ValuePart(RoleValue):
    """The part of a machine that contains a value. An event variable that is available only in a part of a handler
    names the condition or the body; no schema uses the others."""

    COND = "cond"
    BODY = "body"
    DATA = "data"
    ENTRY = "onentry"
    EXIT = "onexit"


class ProtocolPart(RoleValue):
    """What an element sends or receives: a part of a ROS interface or of the protocol of tree nodes, an event, a value
    of the blackboard, or the tick of a timer."""

    BLACKBOARD = "blackboard"
    BT_HALT = "bt-halt"
    BT_HALTED = "bt-halted"
    BT_STATUS = "bt-status"
    BT_TICK = "bt-tick"
    CANCEL = "cancel"
    CHILD_HALT = "child-halt"
    CHILD_HALTED = "child-halted"
    CHILD_STATUS = "child-status"
    CHILD_TICK = "child-tick"
    EVENT = "event"
    FEEDBACK = "feedback"
    GOAL = "goal"
    GOAL_ACCEPTED = "goal-accepted"
    GOAL_REJECTED = "goal-rejected"
    GOAL_RESPONSE = "goal-response"
    MESSAGE = "message"
    REQUEST = "request"
    RESPONSE = "response"
    RESULT = "result"
    THREAD_FREE = "thread-free"
    THREAD_START = "thread-start"
    TICK = "tick"

    START = "start"
    """The start of a machine, before its first event. No schema uses it."""


UNBOUNDED = 1_000_000
"""The maximum number of children if there is no limit."""


class NodeKind(RoleValue):
    """The kind of a node of a behavior tree."""

    CONTROL = "control"
    DECORATOR = "decorator"
    ACTION = "action"
    CONDITION = "condition"
    SUBTREE = "subtree"

    @property
    def children(self) -> tuple[int, int]:
        """The minimum and maximum number of children of a node of this kind."""
        match self:
            case NodeKind.CONTROL:
                return (1, UNBOUNDED)
            case NodeKind.DECORATOR:
                return (1, 1)
            case NodeKind.ACTION | NodeKind.CONDITION | NodeKind.SUBTREE:
                return (0, 0)


class Direction(RoleValue):
    """The direction of a port. Ports of plugins in systems and of the schema are not `INOUT`."""

    IN = "in"
    OUT = "out"
    INOUT = "inout"

    @property
    def reads(self) -> bool:
        return self is not Direction.OUT

    @property
    def writes(self) -> bool:
        return self is not Direction.IN


class ValueRole(RoleValue):
    """The meaning of an attribute's value that neither defines nor names a symbol."""

    CHILD_INDEX = "child-index"
    CONSTANT = "constant"
    EXPRESSION = "expression"
    LOCATION = "location"
    NUMBER = "number"
    PATH = "path"
    ROS_TYPE = "ros-type"
    SCRIPT = "script"
    STATUS = "status"
    TYPE = "type"
