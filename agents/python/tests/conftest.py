"""A running session for the tests that join one."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import tempfile
import uuid
from collections.abc import Iterator

import pytest


@pytest.fixture(scope="module")
def session() -> Iterator[str]:
    """The name of a session with two robots and a panorama, run by the binary that ``COHABIT`` names."""
    binary = os.environ.get("COHABIT")
    if not binary:
        pytest.skip("COHABIT does not name the binary `cohabit`: no session can be started")
    name = f"py-{uuid.uuid4().hex[:12]}"
    with tempfile.TemporaryDirectory() as folder:
        log = str(pathlib.Path(folder) / "session.mcap")
        command = [binary, "play", "--port", "0", "--session", name, "--log", log, "--body", "robot"]
        command += ["--camera", "around=panorama,size=32,rate=20", "--camera", "map=top-down,size=64x48,planes=color"]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            for line in process.stdout:
                if "http://" in line:
                    break
            yield name
            process.send_signal(signal.SIGINT)
            process.stdout.read()
            assert process.wait(60) == 0
