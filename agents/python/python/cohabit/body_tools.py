"""What a body can do, as tools for language models: JSON Schema in the shape of OpenAI's functions or of MCP's tools."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, Optional, Union

from gymnasium.error import ResetNeeded

from . import _native
from .actions import Action, GoTo, Interact, LookAround, Move, PickUp, Place, Rotate
from .env import Env
from .session import Session

_OBJECT: dict[str, Any] = {
    "type": "string",
    "minLength": 1,
    "description": "the object: what people call it, its class, or its instance id, such as `Bowl_01_1`",
}


class Tools:
    """The tools of one body: :meth:`schemas` describes them, and :meth:`call` uses one."""

    def __init__(self, body: Union[Session, Env]) -> None:
        self.body = body
        self._described = _described(body.office.packs if isinstance(body, Env) else [])

    def schemas(self, shape: Literal["openai", "mcp"] = "openai") -> list[dict[str, Any]]:
        """A description of each tool, as ``tools`` of OpenAI's chat completions, or of an answer of MCP's ``tools/list``."""
        if shape not in ("openai", "mcp"):
            raise ValueError(f"there is no shape `{shape}`: openai or mcp")
        if shape == "mcp":
            return [{"name": name, "description": text, "inputSchema": schema} for name, text, schema in self._described]
        described = ({"name": name, "description": text, "parameters": schema} for name, text, schema in self._described)
        return [{"type": "function", "function": function} for function in described]

    def call(self, name: str, arguments: Mapping[str, Any]) -> str:
        """Has the body do it, and says in a sentence what came of it, also where it was refused or made no sense."""
        try:
            action = _action(name, arguments, self._described)
        except ValueError as error:
            return f"Refused: {error}."
        if isinstance(self.body, Env):
            try:
                info = self.body.act(action)[-1]
            except ResetNeeded:
                return "Refused: no episode has begun: reset the environment first."
            status, detail = info["status"], info["detail"]
        else:
            outcome = self.body.do(action)
            status, detail = outcome.status, outcome.detail
        if status in ("ActionSuccessful", "AlternateNavigationUsed"):
            return detail or "Done."
        return f"Refused ({status or 'not ended'}): {detail or 'nothing came of it yet'}"


Described = Sequence[tuple[str, str, dict[str, Any]]]
"""Name, description and JSON Schema of each tool."""


def tools(body: Union[Session, Env]) -> Tools:
    """The tools of a body: that of a session that was joined, or of an environment, which may be wrapped.

    Raises ``TypeError`` for anything else, such as an environment of many bodies or worlds.
    """
    inner = body if isinstance(body, Session) else getattr(body, "unwrapped", body)
    if not isinstance(inner, (Session, Env)):
        raise TypeError(
            f"tools are those of one body, in a session that was joined or in a cohabit.Env: a {type(inner).__name__} has none"
        )
    return Tools(inner)


def _described(packs: list[str]) -> Described:
    described: list[tuple[str, str, dict[str, Any]]] = []
    for name, text, argument in _native.body_tools(packs):
        properties: dict[str, Any] = {} if argument is None else {argument[0]: _property(argument[1])}
        described.append((name, text, _schema(properties)))
    return described


def _property(bounds: Optional[tuple[float, float]]) -> dict[str, Any]:
    return _OBJECT if bounds is None else {"type": "number", "minimum": bounds[0], "maximum": bounds[1]}


def _schema(properties: dict[str, Any]) -> dict[str, Any]:
    return {"type": "object", "properties": properties, "required": list(properties), "additionalProperties": False}


def _action(name: str, arguments: Mapping[str, Any], described: Described) -> Action:
    """The action of a call. Raises ``ValueError`` that says what is wrong with it."""
    schemas = {known: schema for known, _, schema in described}
    if name not in schemas:
        raise ValueError(f"there is no tool `{name}`: one of {', '.join(schemas)}")
    wanted = schemas[name]["properties"]
    if set(arguments) != set(wanted):
        raise ValueError(f"`{name}` takes {', '.join(wanted) or 'no arguments'}, not {', '.join(arguments) or 'nothing'}")
    if name == "look_around":
        return LookAround()
    if name in ("move", "turn"):
        ((argument, bounds),) = wanted.items()
        value, low, high = arguments[argument], bounds["minimum"], bounds["maximum"]
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not low <= value <= high:
            raise ValueError(f"`{argument}` is {value!r}: a number from {low} to {high}")
        return Move(value) if name == "move" else Rotate(value)
    thing = arguments["object"]
    if not isinstance(thing, str) or not thing:
        raise ValueError(f"`object` is {thing!r}: the name of an object")
    deeds: dict[str, Callable[[str], Action]] = {"go_to": GoTo, "pick_up": PickUp, "place": Place}
    return deeds[name](thing) if name in deeds else Interact(name, thing)
