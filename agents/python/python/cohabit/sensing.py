"""What a body of an environment senses: its cameras, its slots, and the space of its observations."""

from __future__ import annotations

import string
from collections.abc import Sequence
from typing import Any, Optional, Union

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from . import _native

PLANES = ("color", "depth", "normals", "ids")
"""The planes there are."""

CHOICES: tuple[str, ...] = tuple(name for name, _ in _native.CHOICES)
"""The kinds of actions of environments, by their numbers."""

MOST_GOALS = 16
"""Goals that an observation tells of."""

MOST_CHARACTERS = 1000
"""The longest instruction in an observation."""

_CHARACTERS = string.ascii_letters + string.digits + string.punctuation + " "
_FARTHEST_M = 1000.0
_PLANE_SPACES: dict[str, tuple[float, float, tuple[int, ...], Any]] = {
    "color": (0, 255, (4,), np.uint8),
    "depth": (0.0, np.inf, (), np.float32),
    "normals": (-128, 127, (4,), np.int8),
    "ids": (0, 2**32 - 1, (), np.uint32),
}
_VIEWS = {"panorama": 4}


class Sensing:
    """How bodies sense; the parameters are those of :class:`~cohabit.office.Office`, and how many classes of objects and
    rooms there are."""

    def __init__(
        self,
        planes: Sequence[str],
        camera: str,
        size: Union[int, tuple[int, int]],
        slots: int,
        fill: Optional[str],
        instruction: bool,
        classes: int,
        rooms: int,
    ) -> None:
        unknown = [plane for plane in planes if plane not in PLANES]
        if unknown:
            raise ValueError(f"there is no plane `{unknown[0]}`: {', '.join(PLANES)}")
        if not 1 <= slots <= 4096:
            raise ValueError(f"{slots} slots: 1 to 4096")
        self.planes = tuple(plane for plane in PLANES if plane in planes)
        self.slots = slots
        self.fill = fill or ("seen" if "ids" in self.planes else "near")
        self.size = (size, size) if isinstance(size, int) else size
        self.camera = camera
        self.kind = camera.split(",", 1)[0]
        self.instruction = instruction
        self.classes, self.rooms = classes, rooms
        self.drawn = self.planes + (("ids",) if self.fill == "seen" and "ids" not in self.planes else ())
        """The planes that are drawn, observed or not."""

    def eyes(self, body: int) -> str:
        """The plan of the camera that a body sees by, which is called ``sense-`` and the body's number."""
        kind, _, options = self.camera.partition(",")
        width, height = self.size
        own = [f"size={width}x{height}", f"planes={'+'.join(self.drawn)}", *([options] if options else [])]
        if kind != "fixed" and "body=" not in options:
            own.append(f"body={body}")
        return f"sense-{body}={kind},{','.join(own)}"

    def cameras(self, bodies: int, render: Optional[tuple[int, int]]) -> list[str]:
        """The plans of the cameras of so many bodies, and of those behind them, if they are watched."""
        cameras = [self.eyes(body) for body in range(bodies)] if self.drawn else []
        if render is not None:
            size = f"size={render[0]}x{render[1]}"
            cameras += [f"watch-{body}=third-person,body={body},{size},planes=color" for body in range(bodies)]
        return cameras

    def observation_space(self) -> spaces.Dict:
        """What a body observes."""
        width, height = self.size
        views = (_VIEWS[self.kind],) if self.kind in _VIEWS else ()
        parts: dict[str, gymnasium.Space[Any]] = {}
        for plane in self.planes:
            low, high, channels, dtype = _PLANE_SPACES[plane]
            parts[plane] = spaces.Box(low, high, (*views, height, width, *channels), dtype)
        parts["position"] = spaces.Box(-_FARTHEST_M, _FARTHEST_M, (3,), np.float32)
        parts["heading"] = spaces.Box(-2 * np.pi, 2 * np.pi, (2,), np.float32)
        parts["room"] = spaces.Discrete(self.rooms)
        parts["held"] = spaces.Discrete(self.classes + 1)
        parts["busy"] = spaces.Discrete(2)
        parts["goals"] = spaces.MultiBinary(MOST_GOALS)
        parts["slot_ids"] = spaces.Box(0, 2**32 - 1, (self.slots,), np.uint32)
        parts["slot_classes"] = spaces.Box(0, self.classes, (self.slots,), np.int64)
        parts["slot_positions"] = spaces.Box(-_FARTHEST_M, _FARTHEST_M, (self.slots, 3), np.float32)
        parts["slot_states"] = spaces.MultiBinary((self.slots, len(_native.FLAGS)))
        if self.instruction:
            parts["instruction"] = spaces.Text(MOST_CHARACTERS, min_length=0, charset=_CHARACTERS)
        return spaces.Dict(parts)

    def action_space(self) -> spaces.MultiDiscrete:
        """What a body chooses from: a choice, and a slot."""
        return spaces.MultiDiscrete([len(CHOICES), self.slots])


def checked_actions(actions: npt.ArrayLike, *worlds: int) -> npt.NDArray[np.int64]:
    """``[choice, slot]`` as an array, or one for each of so many worlds. Raises ``ValueError`` that says what is expected and what
    was given."""
    expected = (*worlds, 2)
    wanted = f"an array of shape {expected} of integers, a choice and a slot" + (" for each world" if worlds else "")
    try:
        given = np.asarray(actions)
    except ValueError:
        raise ValueError(f"actions that are no array: expected {wanted}") from None
    if given.shape != expected or given.dtype.kind not in "iu":
        raise ValueError(f"actions of shape {given.shape} and type {given.dtype}: expected {wanted}")
    return given.astype(np.int64, copy=False)


def sample_actions(masks: npt.ArrayLike, random: Optional[np.random.Generator] = None) -> npt.NDArray[np.int64]:
    """An action for each row of masks, ``[N, 2]``: its choice and its slot are drawn of those that may be tried, each as likely
    as any other. Whether the two go together, ``affordances`` says.

    :param masks: which may be tried, ``[N, choices + slots]``, as ``infos["action_masks"]`` of a vector. Where nothing may be
        tried, the choice or the slot is 0.
    :param random: what draws; anew by chance, if left out.
    """
    given = np.asarray(masks)
    if given.ndim != 2 or given.shape[1] <= len(CHOICES):
        wanted = f"[N, {len(CHOICES)} + slots]: a truth for each choice, then for each slot"
        raise ValueError(f"masks of shape {given.shape}: expected {wanted}")
    # Of numbers drawn alike, each is as likely the highest.
    drawn = (given != 0) * (1.0 + (random or np.random.default_rng()).random(given.shape))
    choices, slots = drawn[:, : len(CHOICES)], drawn[:, len(CHOICES) :]
    return np.stack([choices.argmax(axis=1), slots.argmax(axis=1)], axis=1).astype(np.int64, copy=False)


def observable(instruction: str) -> str:
    """An instruction as observations have it: cut off, and with ``?`` for characters that they do not have."""
    known = set(_CHARACTERS)
    return "".join(one if one in known else "?" for one in instruction[:MOST_CHARACTERS])
