"""Builds the wheel as maturin does, with the program `cohabit` in it, which sessions are run by."""

import json
import shutil
import subprocess
from pathlib import Path

import maturin
from maturin import (  # noqa: F401, the hooks that stay as they are
    build_editable,
    get_requires_for_build_editable,
    get_requires_for_build_wheel,
    prepare_metadata_for_build_editable,
    prepare_metadata_for_build_wheel,
)

PACKAGE = Path(__file__).resolve().parent.parent
#: What maturin takes to be installed beside the interpreter: the data folder of the native module.
SCRIPTS = PACKAGE / "cohabit._native.data/scripts"


def build_wheel(wheels, config_settings=None, metadata_directory=None):
    SCRIPTS.mkdir(parents=True, exist_ok=True)
    try:
        shutil.copy2(built_program(), SCRIPTS)
        return maturin.build_wheel(wheels, config_settings, metadata_directory)
    finally:
        shutil.rmtree(SCRIPTS.parent)


def build_sdist(folder, config_settings=None):
    raise RuntimeError("the program is part of the repository and not of this package's sources: build a wheel (`pip wheel ./agents/python`)")


def built_program():
    """The program's path, after cargo has built it."""
    build = ["cargo", "build", "--release", "--locked", "--package", "cohabit", "--message-format", "json-render-diagnostics"]
    told = subprocess.run(build, cwd=PACKAGE, stdout=subprocess.PIPE, check=True, text=True).stdout
    programs = [message["executable"] for message in map(json.loads, told.splitlines()) if message.get("executable")]
    return Path(programs[-1])
