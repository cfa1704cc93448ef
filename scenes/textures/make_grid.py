#!/usr/bin/env python3
"""Writes grid.png: 8 x 8 cells, hue by column, darker towards the bottom, a white cell at the bottom left, dark lines.

Whoever looks at it on a model sees at once whether texture coordinates are flipped, turned or stretched."""
import colorsys
import struct
import zlib

SIZE, CELLS, LINE = 256, 8, 2
CELL = SIZE // CELLS


def texel(x, y):
    """Colour of a texel; y counts from the top."""
    column, row = x // CELL, y // CELL
    if min(x % CELL, y % CELL) < LINE or max(x % CELL, y % CELL) >= CELL - LINE:
        return (40, 40, 48)
    if column == 0 and row == CELLS - 1:
        return (250, 250, 250)
    value = 1.0 - 0.5 * row / (CELLS - 1) - (0.12 if (column + row) % 2 else 0.0)
    return tuple(round(255 * c) for c in colorsys.hsv_to_rgb(column / CELLS, 0.62, value))


def chunk(kind, data):
    body = kind + data
    return struct.pack(">I", len(data)) + body + struct.pack(">I", zlib.crc32(body))


rows = b"".join(b"\0" + b"".join(bytes(texel(x, y)) for x in range(SIZE)) for y in range(SIZE))
with open("grid.png", "wb") as file:
    file.write(b"\x89PNG\r\n\x1a\n")
    file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0)))
    file.write(chunk(b"IDAT", zlib.compress(rows, 9)))
    file.write(chunk(b"IEND", b""))
