"""Lays pictures side by side, a column a renderer, and says how far each shows what the first one shows.

python sheet.py FOLDER WIDTH HEIGHT CAMERAS NAME...
"""

import struct
import sys
import zlib
from pathlib import Path

import numpy as np


def read(path, width, height):
    """The planes of a kept picture: colour, depth in metres, each pixel's object."""
    raw, pixels = path.read_bytes(), width * height
    color = np.frombuffer(raw, "u1", pixels * 3).reshape(height, width, 3)
    depth_m = np.frombuffer(raw, "<f4", pixels, pixels * 3).reshape(height, width)
    return color, depth_m, np.frombuffer(raw, "<i4", pixels, pixels * 7).reshape(height, width)


def shown(color, depth_m, objects):
    """Colour, depth and objects as they are looked at, one above the other."""
    grey = 255 - np.clip(depth_m * 25, 0, 255)
    mixed = (objects + 1).astype("u4") * np.uint32(0x9E3779B1)
    hues = np.stack([mixed >> 24, mixed >> 16 & 255, mixed >> 8 & 255], axis=-1)
    return np.concatenate([color, np.repeat(grey[:, :, None], 3, axis=2), hues]).astype("u1")


def write_png(path, image):
    """Writes `[height, width, 3]` bytes."""

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", image.shape[1], image.shape[0], 8, 2, 0, 0, 0)
    rows = zlib.compress(b"".join(b"\0" + row.tobytes() for row in image))
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b""))


def main():
    folder, (width, height, cameras), names = Path(sys.argv[1]), map(int, sys.argv[2:5]), sys.argv[5:]
    alike = np.zeros((len(names), 2))
    for camera in range(cameras):
        pictures = [read(folder / f"{name}-{camera}.raw", width, height) for name in names]
        _, depth_m, objects = pictures[0]
        for row, (_, depth, seen) in zip(alike, pictures, strict=True):
            row += (seen == objects).mean(), (np.abs(depth - depth_m) < 0.02 * depth_m).mean()
        write_png(folder / f"{camera}.png", np.concatenate([shown(*picture) for picture in pictures], axis=1))
    for name, (objects, depths) in zip(names, alike * 100 / cameras, strict=True):
        print(f"{name}: same object on {objects:.1f} % of the pixels, same depth within 2 % on {depths:.1f} %")


if __name__ == "__main__":
    main()
