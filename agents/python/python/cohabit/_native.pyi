"""The part of the package that is not Python."""

from collections.abc import Sequence
from typing import Any, Optional, Union, final

import numpy as np
import numpy.typing as npt

VERSION: str
CHOICES: list[tuple[str, bool]]
"""The kinds of actions of environments, and whether each is done to an object."""
ROOMS: list[str]
PACKS: list[str]
"""The names of the world packs that come with the program."""
KINDS: list[str]
COLORS: list[str]
FLUIDS: list[str]
FLAGS: list[str]
VERBS: list[str]
STATUSES: list[str]

class Error(Exception): ...

def class_ids(world: list[str] = ...) -> list[str]:
    """The ids of all classes of objects, by their numbers; ``world`` are folders of world packs, here and below."""

def room_id(text: str) -> Optional[str]:
    """The id of the room that is called that, built in or of a pack that was read."""

def room_ids(world: list[str] = ...) -> list[str]:
    """The ids of all rooms, by their numbers."""

def mission_text(name: Optional[str] = None, world: list[str] = ...) -> tuple[str, str]: ...
def builtin_missions() -> list[str]: ...
def pack_missions(world: list[str]) -> list[tuple[str, str]]:
    """The names and the texts of the missions of world packs."""

def generate_missions(
    count: int, seed: int, types: Optional[list[str]], blockers: Optional[float], workers: int, world: list[str] = ...
) -> tuple[list[str], list[tuple[str, int, str]]]:
    """Lines of a file of missions."""

def part_missions(missions: list[tuple[str, str, list[str], list[str]]], share: float, seed: int) -> list[str]:
    """The part that each mission, given by type, floor plan, rooms and things, belongs to."""

def body_tools(world: list[str] = ...) -> list[tuple[str, str, Optional[tuple[str, Optional[tuple[float, float]]]]]]:
    """The tools of a body: the name, what it does, and its argument, if any: the name and, of a number, lowest and highest."""

def choice_action(choice: int, object: int) -> Optional[Action]: ...
@final
class Action:
    """An action. Its object is a number, or a sentence that says why there is none: it is then refused for that reason."""

    @staticmethod
    def move(distance_m: float) -> Action: ...
    @staticmethod
    def rotate(yaw_rad: float) -> Action: ...
    @staticmethod
    def look(pitch_rad: float) -> Action: ...
    @staticmethod
    def look_around() -> Action: ...
    @staticmethod
    def go_to_object(object: Union[int, str]) -> Action: ...
    @staticmethod
    def go_to_room(room: str) -> Action: ...
    @staticmethod
    def go_to_viewpoint(room: str, number: int) -> Action: ...
    @staticmethod
    def go_to_point(x_m: float, y_m: float) -> Action: ...
    @staticmethod
    def pick_up(object: Union[int, str]) -> Action: ...
    @staticmethod
    def place(receptacle: Union[int, str], beside: Optional[Union[int, str]] = ...) -> Action: ...
    @staticmethod
    def interact(verb: str, object: Union[int, str]) -> Action: ...
    @staticmethod
    def highlight(object: Union[int, str]) -> Action: ...
    @staticmethod
    def drive(forward_m_s: float, turn_rad_s: float, pitch_rad_s: float) -> Action: ...
    @staticmethod
    def stop() -> Action: ...

@final
class Memory:
    @property
    def __array_interface__(self) -> dict[str, Any]: ...

@final
class Outcome:
    """What came of a command; true if it did what was asked."""

    @property
    def command(self) -> int: ...
    @property
    def body(self) -> int: ...
    @property
    def status(self) -> str:
        """One of ``STATUSES``."""
    @property
    def success(self) -> bool: ...
    @property
    def detail(self) -> str:
        """A sentence for people."""
    def __bool__(self) -> bool: ...

@final
class Seen:
    """Something that is seen in a frame."""

    @property
    def id(self) -> int:
        """Its id in the id plane."""
    @property
    def object(self) -> Optional[int]:
        """The object's number, if it is one."""
    @property
    def body(self) -> Optional[int]:
        """The body's number, if it is one."""
    @property
    def class_id(self) -> str:
        """The id of its class, or what else it is: ``robot``, ``person``, ``floor``, ``wall``."""
    @property
    def name(self) -> str:
        """What people call things of its kind."""
    @property
    def view(self) -> int:
        """The picture: 0, or up to 3 of a panorama."""
    @property
    def pixels(self) -> int: ...
    @property
    def bounds(self) -> tuple[int, int, int, int]:
        """``(left, top, right, bottom)``: the first column and row, and those after the last."""

@final
class Frame:
    """One frame. Its planes are read-only arrays over the memory that it was rendered into.

    A panorama's planes have its four pictures first: ``[4, height, width, …]``.
    """

    @property
    def tick(self) -> int:
        """When the world was so."""
    @property
    def width(self) -> int: ...
    @property
    def height(self) -> int: ...
    @property
    def views(self) -> int:
        """Pictures: 1, or 4 of a panorama."""
    @property
    def body(self) -> Optional[int]: ...
    @property
    def position(self) -> tuple[float, float, float]:
        """The camera's place in the world, m."""
    @property
    def yaw_rad(self) -> float: ...
    @property
    def pitch_rad(self) -> float: ...
    @property
    def fov_y_rad(self) -> float: ...
    @property
    def seen_nanos(self) -> int:
        """When the world was so, as ``time.monotonic_ns`` counts."""
    @property
    def command(self) -> int:
        """The latest command that had begun to move a body by then."""
    @property
    def planes(self) -> list[str]: ...
    @property
    def color(self) -> npt.NDArray[np.uint8]:
        """``[height, width, 4]``: red, green, blue, 255."""
    @property
    def depth(self) -> npt.NDArray[np.float32]:
        """``[height, width]``: metres along the camera's axis."""
    @property
    def normals(self) -> npt.NDArray[np.int8]:
        """``[height, width, 4]``: the surface's normal in the world, times 127, and 0."""
    @property
    def ids(self) -> npt.NDArray[np.uint32]:
        """``[height, width]``: whose pixel it is; 0 is nothing."""
    @property
    def seen(self) -> list[Seen]:
        """What is seen, by picture, then by id."""
    def __getitem__(self, plane: str) -> npt.NDArray[Any]: ...

@final
class Body:
    """A robot or a person."""

    @property
    def id(self) -> int: ...
    @property
    def kind(self) -> str: ...
    @property
    def room(self) -> str: ...
    @property
    def held(self) -> Optional[int]:
        """The number of the object that it holds."""
    @property
    def busy(self) -> bool: ...
    @property
    def command(self) -> int: ...
    @property
    def commander(self) -> int:
        """Whoever commands it; 0 is nobody."""
    @property
    def position(self) -> tuple[float, float, float]:
        """On the floor, m."""
    @property
    def yaw_rad(self) -> float:
        """Heading, counter-clockwise from east."""
    @property
    def head_pitch_rad(self) -> float: ...
    @property
    def eye(self) -> tuple[float, float, float]:
        """Where its camera is, m."""
    @property
    def flags(self) -> list[str]: ...

@final
class Object:
    """An object."""

    @property
    def id(self) -> int: ...
    @property
    def instance(self) -> str: ...
    @property
    def class_id(self) -> str: ...
    @property
    def name(self) -> str:
        """What people call it."""
    @property
    def room(self) -> str: ...
    @property
    def flags(self) -> list[str]: ...
    @property
    def color(self) -> str: ...
    @property
    def fluid(self) -> str: ...
    @property
    def hidden(self) -> bool: ...
    @property
    def in_mission(self) -> bool: ...
    @property
    def parent(self) -> Optional[int]:
        """The number of what it stands on or in."""
    @property
    def held_by(self) -> Optional[int]: ...
    @property
    def works(self) -> Optional[int]: ...
    @property
    def position(self) -> tuple[float, float, float]:
        """Its origin, m."""
    @property
    def rotation(self) -> tuple[float, float, float, float]:
        """A quaternion, x, y, z, w."""

@final
class Goal:
    """A goal of the mission."""

    @property
    def number(self) -> int: ...
    @property
    def met(self) -> bool: ...
    @property
    def hidden(self) -> bool: ...
    @property
    def description(self) -> str: ...

@final
class State:
    """The world at one tick. It is a copy: keep as many as you like."""

    @property
    def tick(self) -> int: ...
    @property
    def score(self) -> int: ...
    @property
    def ending(self) -> str:
        """``running``, ``complete`` or ``failed``."""
    @property
    def paused(self) -> bool: ...
    @property
    def lit_rooms(self) -> list[str]: ...
    @property
    def bodies(self) -> list[Body]: ...
    @property
    def objects(self) -> list[Object]: ...
    @property
    def goals(self) -> list[Goal]: ...
    @property
    def notes(self) -> list[tuple[int, str, bool]]:
        """What the sticky notes say: the object's number, the text, whether it was read."""
    @staticmethod
    def of_payload(payload: bytes, tick: int, world: list[str] = ...) -> State: ...
    @property
    def world(self) -> list[str]:
        """The folders of the world's packs."""
    def payload(self) -> bytes:
        """All of it as bytes."""
    def find(self, name: Union[int, str], near: int = 0) -> Object:
        """The object of that number, instance id, or class: then the nearest to a body. Raises ``KeyError``."""
    def records(self, list: str) -> tuple[int, npt.NDArray[np.uint8]]: ...

@final
class Senses:
    @property
    def position(self) -> npt.NDArray[np.float32]: ...
    @property
    def yaw_rad(self) -> float: ...
    @property
    def head_pitch_rad(self) -> float: ...
    @property
    def room(self) -> int: ...
    @property
    def held_class(self) -> int: ...
    @property
    def busy(self) -> bool: ...
    @property
    def ids(self) -> npt.NDArray[np.uint32]: ...
    @property
    def classes(self) -> npt.NDArray[np.int64]: ...
    @property
    def positions(self) -> npt.NDArray[np.float32]: ...
    @property
    def flags(self) -> npt.NDArray[np.int8]: ...
    @property
    def afforded(self) -> npt.NDArray[np.int8]: ...

@final
class Stage:
    def __new__(
        cls,
        mission: Optional[str] = None,
        text: Optional[str] = None,
        bodies: list[str] = ...,
        cameras: list[str] = ...,
        seed: int = 0,
        threads: int = 1,
        randomize: bool = False,
        world: list[str] = ...,
    ) -> Stage: ...
    def reset(self, seed: int, mission: Optional[str] = None, text: Optional[str] = None) -> None: ...
    def made_of(self) -> tuple[str, str, list[str], list[str], int, int, bool, list[str]]:
        """The arguments of a stage that is the same at its beginning."""
    def save(self) -> tuple[bytes, int, list[tuple[int, int, Optional[str]]], list[list[int]]]:
        """This moment, for :meth:`load`."""
    def load(
        self, state: bytes, commanded: int, pending: list[tuple[int, int, Optional[str]]], slots: list[list[int]]
    ) -> None:
        """Goes on from a moment of a stage that was made of the same."""
    def act(self, actions: list[tuple[int, Action]], ticks: Optional[int] = None) -> list[Outcome]: ...
    def choose(self, choices: list[tuple[int, int, int]], ticks: Optional[int] = None) -> list[Outcome]: ...
    def look(self, cameras: list[str]) -> list[Frame]: ...
    def sense(self, bodies: list[int], slots: int, filling: str, frames: list[Frame]) -> list[Senses]: ...
    def progress(self) -> tuple[int, int, str, list[tuple[int, bool]]]: ...
    def state(self) -> State: ...
    def digest(self) -> bytes: ...
    def kinds(self) -> list[str]: ...
    def mission(self) -> tuple[str, int]: ...

@final
class VecStage:
    """Worlds that are stepped together by threads of their own."""

    def __new__(
        cls,
        missions: Sequence[tuple[Optional[str], Optional[str]]],
        bodies: list[str],
        cameras: list[str],
        eyes: Optional[str],
        planes: list[str],
        slots: int,
        filling: str,
        ticks: Optional[int],
        most_steps: int,
        threads: int,
        randomize: bool,
        remembers: bool = False,
        world: list[str] = ...,
    ) -> VecStage: ...
    def layout(self) -> list[tuple[str, int, int, list[int], str]]:
        """Where arrays are in pages: name, page, first byte, shape, type."""
    def turn(
        self,
        choices: bytes,
        steps: bytes,
        beginnings: list[tuple[int, int, Optional[tuple[Optional[str], Optional[str]]]]],
    ) -> tuple[list[npt.NDArray[np.uint8]], list[str], list[str], list[str]]:
        """One turn of all worlds: ``choices`` are the bytes of ``[worlds, 2]`` i8, ``steps`` those of a truth for each world that
        goes on. Gives the pages, and of each world the status and the detail of its command, and its ending."""
    def act(
        self,
        actions: list[Action],
        beginnings: list[tuple[int, int, Optional[tuple[Optional[str], Optional[str]]]]],
    ) -> tuple[list[npt.NDArray[np.uint8]], list[str], list[str], list[str]]:
        """The same with an action in words for each world."""
    def known(self, world: int) -> list[int]:
        """The numbers of the objects that the body of a world has seen in this episode, if that is noted."""
    def look(self, world: int, camera: str) -> Frame: ...
    def state(self, world: int) -> State: ...
    def digest(self, world: int) -> bytes: ...

@final
class Heard:
    """Something that was told or said in a session."""

    @property
    def kind(self) -> str:
        """``outcome``, ``started``, ``goal_met``, ``sound``, ``utterance``, ``reply`` and so on."""
    @property
    def tick(self) -> int: ...
    @property
    def body(self) -> Optional[int]: ...
    @property
    def object(self) -> Optional[int]: ...
    @property
    def command(self) -> int: ...
    @property
    def turn(self) -> int: ...
    @property
    def number(self) -> int: ...
    @property
    def status(self) -> str: ...
    @property
    def text(self) -> str: ...

@final
class Command:
    """A command that was given."""

    @property
    def number(self) -> int: ...
    def poll(self) -> Optional[Outcome]:
        """What came of it, if it has ended."""
    def wait(self, timeout: Optional[float] = None) -> Outcome:
        """What came of it. Raises ``TimeoutError`` after ``timeout`` seconds; waits for ever if none is given."""

@final
class Session:
    def __new__(cls, name: str, body: int, timeout: float) -> Session: ...
    @property
    def name(self) -> str: ...
    @property
    def mission(self) -> str: ...
    @property
    def mission_text(self) -> str:
        """The mission file (CDF), as JSON."""
    @property
    def seed(self) -> int: ...
    @property
    def lock_step(self) -> bool: ...
    @property
    def cameras(self) -> list[tuple[str, str, int, int, list[str]]]: ...
    def state(self, timeout: float = 5.0) -> State: ...
    def sense(self, slots: int, filling: str, frame: Optional[Frame] = None) -> Senses: ...
    def look(self, camera: str, timeout: float = 5.0) -> Frame: ...
    def open_camera(self, camera: str) -> None: ...
    def close_camera(self, camera: str) -> None: ...
    def hear(self, timeout: Optional[float] = None) -> Optional[Heard]: ...
    @property
    def body(self) -> int: ...
    @property
    def commands_body(self) -> bool: ...
    def claim(self, take_over: bool) -> Command: ...
    def release(self) -> None: ...
    def act(self, action: Action) -> Command: ...
    def attend(self, patience: Optional[float] = None) -> None: ...
    def leave(self) -> None: ...
    def ready(self, ticks: int) -> None: ...
    def turn(self, timeout: Optional[float] = None) -> int: ...
    def say(self, text: str) -> None: ...
