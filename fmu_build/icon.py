"""Draws src/fmu/package/model.png: a streamlined deck section in the wind. Standard library only, same bytes on
every run: python3 fmu_build/icon.py"""

import math
import pathlib
import struct
import zlib

SIZE, FINE = 128, 4  # pixels, samples per pixel and axis
WHITE, DECK, EDGE, WIND = (255, 255, 255), (70, 110, 160), (20, 40, 70), (120, 170, 210)


def rotated(points, angle_deg, centre=(64.0, 66.0)):
    c, s = math.cos(math.radians(angle_deg)), math.sin(math.radians(angle_deg))
    return [(centre[0] + c * x + s * y, centre[1] - s * x + c * y) for x, y in points]


def inside(polygon, x, y):
    hit = False
    for (x1, y1), (x2, y2) in zip(polygon, polygon[1:] + polygon[:1]):
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) * (x2 - x1) / (y2 - y1):
            hit = not hit
    return hit


def near(polygon, x, y, width):
    for (x1, y1), (x2, y2) in zip(polygon, polygon[1:] + polygon[:1]):
        length2 = (x2 - x1) ** 2 + (y2 - y1) ** 2
        t = max(0.0, min(1.0, ((x - x1) * (x2 - x1) + (y - y1) * (y2 - y1)) / length2))
        if math.hypot(x - x1 - t * (x2 - x1), y - y1 - t * (y2 - y1)) <= width:
            return True
    return False


# a closed box with fairings, nose to the wind, turned nose-up by 8 degrees
SECTION = rotated([(-54, 0), (-40, -9), (40, -9), (54, 0), (22, 12), (-22, 12)], -8)


def wind(x, y):
    """Three streamlines that part around the deck."""
    for base, bend in ((22, -5), (108, 6), (121, 3)):
        line = base + bend * math.sin(math.pi * x / SIZE) ** 2
        if abs(y - line) < 1.6 and 8 < x < 120:
            return True
    return False


def colour(x, y):
    if near(SECTION, x, y, 2.0):
        return EDGE
    if inside(SECTION, x, y):
        return DECK
    return WIND if wind(x, y) else WHITE


def rows():
    for row in range(SIZE):
        line = bytearray([0])
        for column in range(SIZE):
            samples = [
                colour(column + (i + 0.5) / FINE, row + (j + 0.5) / FINE)
                for i in range(FINE)
                for j in range(FINE)
            ]
            line += bytes(round(sum(channel) / len(samples)) for channel in zip(*samples))
        yield bytes(line)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def main():
    header = struct.pack(">IIBBBBB", SIZE, SIZE, 8, 2, 0, 0, 0)
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header)
    png += chunk(b"IDAT", zlib.compress(b"".join(rows()), 9)) + chunk(b"IEND", b"")
    target = pathlib.Path(__file__).parent.parent / "src" / "fmu" / "package" / "model.png"
    target.write_bytes(png)


if __name__ == "__main__":
    main()
