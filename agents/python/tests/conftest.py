"""Running sessions for the tests that join one."""

from __future__ import annotations

import contextlib
import pathlib
import signal
import subprocess
import sys
import tempfile
import uuid
from collections.abc import Iterator

import pytest


@contextlib.contextmanager
def playing(*arguments: str) -> Iterator[str]:
    """The name of a session with those arguments, run by the program that was installed along."""
    binary = str(pathlib.Path(sys.executable).with_name("cohabit"))
    name = f"py-{uuid.uuid4().hex[:12]}"
    with tempfile.TemporaryDirectory() as folder:
        log = str(pathlib.Path(folder) / "session.mcap")
        command = [binary, "play", "--port", "0", "--session", name, "--log", log, *arguments]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                if "http://" in line:
                    break
            yield name
            process.send_signal(signal.SIGINT)
            process.stdout.read()
            assert process.wait(60) == 0


@pytest.fixture(scope="module")
def session() -> Iterator[str]:
    """Two robots, a panorama and a map, in real time."""
    cameras = ["--camera", "around=panorama,size=32,rate=20", "--camera", "map=top-down,size=64x48,planes=color"]
    with playing("--body", "robot", *cameras) as name:
        yield name


@pytest.fixture(scope="module")
def lock_step_session() -> Iterator[str]:
    """Two robots in lock-step; the second has a small camera besides."""
    with playing("--body", "robot", "--camera", "small=egocentric,body=1,size=48", "--lock-step") as name:
        yield name
