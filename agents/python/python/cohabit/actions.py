"""What a body can be told to do.

Objects are given by number, by instance id (``"Bowl_01_1"``) or by class (``"Bowl_01"``, ``"bowl"``): the nearest to the
body that is not hidden. An action on a name that is unknown is refused: its outcome says so, and names that are similar.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Collection
from dataclasses import dataclass
from typing import Optional, Protocol, Union

from . import _native

ObjectRef = Union[int, str, _native.Object, _native.Seen]
"""An object: its number, a name, or what ``state`` or a frame gave for it."""


class Names(Protocol):
    """What objects are called by whoever acts: a state, or what is known of one."""

    @property
    def objects(self) -> list[_native.Object]:
        """All objects that can be named."""

    def find(self, name: Union[int, str], near: int = 0) -> _native.Object:
        """The object of that number, instance id, or class: then the nearest to a body. Raises ``KeyError``."""


class Known:
    """What is known of a state: some of its objects alone."""

    def __init__(self, state: _native.State, known: Collection[int]) -> None:
        self._state = state
        self._known = known

    @property
    def objects(self) -> list[_native.Object]:
        """Those that are known."""
        return [thing for thing in self._state.objects if thing.id in self._known]

    def find(self, name: Union[int, str], near: int = 0) -> _native.Object:
        """The one of that number, instance id, or class: then the nearest to a body. Raises ``KeyError``."""
        at = next((body.position for body in self._state.bodies if body.id == near), (0.0, 0.0, 0.0))
        known = self.objects
        exact = [thing for thing in known if name in (thing.id, thing.instance)]
        alike = [thing for thing in known if thing.class_id == name or thing.name.lower() == str(name).lower()]
        if not exact and not alike:
            raise KeyError(f"no object {name} is known")
        return min(exact or alike, key=lambda thing: (thing.hidden, math.dist(thing.position, at)))


def resolve(reference: ObjectRef, state: Names, body: int, rooms: bool = False) -> Union[int, str]:
    """The number of the object that is meant, or a sentence that says why there is none; ``rooms`` may be meant too."""
    if isinstance(reference, _native.Seen):
        return f"{reference!r} is no object" if reference.object is None else reference.object
    if isinstance(reference, _native.Object):
        reference = reference.id
    if isinstance(reference, int) and not isinstance(state, Known):
        return reference
    try:
        return state.find(reference, near=body).id
    except KeyError:
        return _unknown(str(reference), state, rooms)


def _unknown(name: str, state: Names, rooms: bool) -> str:
    """Says that nothing is called that, and what is called something similar."""
    known = {called for thing in state.objects for called in (thing.name, thing.class_id, thing.instance)}
    known.update(_native.ROOMS if rooms else ())
    spelled = {called.lower(): called for called in sorted(known)}
    near = [spelled[called] for called in difflib.get_close_matches(name.lower(), sorted(spelled), 3)]
    kinds = "object or room" if rooms else "object"
    if isinstance(state, Known):
        missing = f"no {kinds} `{name}` has been seen yet"
    else:
        missing = f"there is no {kinds} `{name}` in this world"
    return missing + (f": did you mean `{'`, `'.join(near)}`?" if near else "")


@dataclass(frozen=True)
class Move:
    """Move along the heading by so many metres; negative is backwards."""

    distance_m: float

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.move(self.distance_m)


@dataclass(frozen=True)
class Rotate:
    """Turn by so many radians; positive is to the left."""

    yaw_rad: float

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.rotate(self.yaw_rad)


@dataclass(frozen=True)
class Look:
    """Pitch the head by so many radians; positive is up."""

    pitch_rad: float

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.look(self.pitch_rad)


@dataclass(frozen=True)
class LookAround:
    """Turn once around, looking."""

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.look_around()


@dataclass(frozen=True)
class GoTo:
    """Walk to an object, a room (``"Lab1"``), a room's viewpoint (``("Lab1", 3)``) or a point ``(x_m, y_m)``, of which a third number,
    the height, says nothing: the ``position`` of a body or an object is one."""

    target: Union[ObjectRef, tuple[str, int], tuple[float, float], tuple[float, float, float]]

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        target = self.target
        if isinstance(target, tuple):
            if len(target) not in (2, 3):
                raise ValueError(f"`target` is {target!r}: a room and a viewpoint's number, or a point (x_m, y_m)")
            first, second = target[:2]
            if isinstance(first, str):
                return _native.Action.go_to_viewpoint(first, int(second))
            return _native.Action.go_to_point(float(first), float(second))
        room = _native.room_id(target) if isinstance(target, str) else None
        if room is not None:
            return _native.Action.go_to_room(room)
        return _native.Action.go_to_object(resolve(target, state, body, rooms=True))


@dataclass(frozen=True)
class PickUp:
    """Take an object into the empty hand."""

    object: ObjectRef

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.pick_up(resolve(self.object, state, body))


@dataclass(frozen=True)
class Place:
    """Put what is held onto or into a receptacle: at the free place nearest to ``beside``, if that is given.

    Where there is no room beside that, it is put all the same, and the status is ``AlternateNavigationUsed``.
    """

    receptacle: ObjectRef
    beside: Optional[ObjectRef] = None

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        receptacle = resolve(self.receptacle, state, body)
        if self.beside is None:
            return _native.Action.place(receptacle)
        return _native.Action.place(receptacle, resolve(self.beside, state, body))


@dataclass(frozen=True)
class Interact:
    """Do one of ``VERBS`` to an object, with the hand or with what it holds."""

    verb: str
    object: ObjectRef

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.interact(self.verb, resolve(self.object, state, body))


@dataclass(frozen=True)
class Highlight:
    """Outline an object for the people who watch."""

    object: ObjectRef

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.highlight(resolve(self.object, state, body))


@dataclass(frozen=True)
class Drive:
    """Move at these speeds for half a simulated second, or until the next command; slides along what is in the way.

    Who sends one after the other drives a body as people do by keyboard.
    """

    forward_m_s: float = 0.0
    turn_rad_s: float = 0.0
    pitch_rad_s: float = 0.0

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.drive(self.forward_m_s, self.turn_rad_s, self.pitch_rad_s)


@dataclass(frozen=True)
class Stop:
    """Let go of whatever it is doing, now."""

    def plain(self, state: Names, body: int) -> _native.Action:
        """The action with its objects as numbers."""
        return _native.Action.stop()


Action = Union[Move, Rotate, Look, LookAround, GoTo, PickUp, Place, Interact, Highlight, Drive, Stop]
"""Any of them."""
