#!/usr/bin/env python3
"""Makes every model and texture of scenes/: run it from anywhere, it needs Python 3 alone.

Models go to scenes/models (OBJ, metres, +Y up), textures to scenes/textures (PNG). The files are
the same on every run.
"""
import math
import os
import struct
import zlib

SCENES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scenes")
TAU = 2 * math.pi


# Textures

def write_png(name, size, color):
    """A square picture; color(u, v) gives RGB in 0..1 (sRGB), v upward."""
    rows = []
    for y in range(size):
        row = bytearray([0])
        for x in range(size):
            rgb = color((x + 0.5) / size, 1 - (y + 0.5) / size)
            row += bytes(max(0, min(255, round(255 * c))) for c in rgb)
        rows.append(bytes(row))

    def chunk(kind, data):
        check = zlib.crc32(kind + data)
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", check)

    header = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    data = zlib.compress(b"".join(rows), 9)
    with open(os.path.join(SCENES, "textures", name), "wb") as out:
        out.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"sRGB", b"\0")
                  + chunk(b"IDAT", data) + chunk(b"IEND", b""))


def hash01(x, y, seed):
    n = (x * 374761393 + y * 668265263 + seed * 2147483647) & 0xFFFFFFFF
    n = ((n ^ (n >> 13)) * 1274126177) & 0xFFFFFFFF
    return ((n ^ (n >> 16)) & 0xFFFF) / 0xFFFF


def noise(u, v, cells, seed):
    """Value noise that repeats over the unit square."""
    x, y = u * cells, v * cells
    i, j = int(x), int(y)
    fx, fy = x - i, y - j
    fx, fy = fx * fx * (3 - 2 * fx), fy * fy * (3 - 2 * fy)
    at = lambda a, b: hash01((i + a) % cells, (j + b) % cells, seed)
    low = at(0, 0) * (1 - fx) + at(1, 0) * fx
    high = at(0, 1) * (1 - fx) + at(1, 1) * fx
    return low * (1 - fy) + high * fy


def clouds(u, v, seed, cells=4, octaves=4):
    return sum(noise(u, v, cells << k, seed + k) / 2 ** (k + 1) for k in range(octaves))


def mix(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def steps(value, count):
    """Few levels keep the files small."""
    return round(value * count) / count


def checker(u, v):
    light = (int(u * 8) + int(v * 8)) % 2 == 0
    vein = steps(clouds(u, v, 3), 24)
    return mix((0.80, 0.78, 0.74), (0.92, 0.91, 0.88), vein) if light else \
        mix((0.20, 0.22, 0.26), (0.34, 0.35, 0.38), vein)


def wood(u, v):
    plank = int(v * 6)
    shift = hash01(plank, 7, 1)
    joint = (v * 6) % 1 < 0.03 or ((u + shift) * 2) % 1 < 0.006
    grain = 0.5 + 0.5 * math.sin(TAU * (6 * v * 6 + 3 * noise((u + shift) % 1, v, 6, 11)))
    tone = steps(0.6 * grain + 0.4 * hash01(plank, int((u + shift) * 2) % 2, 5), 16)
    return (0.22, 0.13, 0.07) if joint else mix((0.46, 0.29, 0.16), (0.64, 0.43, 0.25), tone)


def herringbone(u, v):
    """Blocks of 4 x 1 in zigzag; its rows run diagonally."""
    i, j = int(16 * u), int(16 * v)
    x, y = 16 * u - i, 16 * v - j
    k = (i - j) % 8
    if k < 4:                               # lying: k-th cell of its block
        along, across, block = k + x, y, hash01((i - k) % 16, j, 15)
    else:                                   # standing
        along, across, block = 7 - k + y, x, hash01(i, (j + k - 7) % 16, 16)
    joint = min(along, 4 - along, across, 1 - across) < 0.05
    wave = 0.7 * noise(along / 4, across, 3, 11)
    grain = 0.5 + 0.5 * math.sin(TAU * (3 * across + 3 * block + wave))
    tone = steps(0.25 * grain + 0.75 * block, 16)
    return (0.56, 0.43, 0.30) if joint else mix((0.76, 0.63, 0.46), (0.89, 0.79, 0.64), tone)


def bricks(u, v):
    row = int(v * 16)
    x = (u * 8 + 0.5 * (row % 2)) % 8
    mortar = (v * 16) % 1 < 0.1 or x % 1 < 0.05
    tone = steps(0.5 * hash01(int(x), row, 9) + 0.5 * clouds(u, v, 21, 16, 2), 16)
    return (0.72, 0.69, 0.64) if mortar else mix((0.50, 0.20, 0.14), (0.70, 0.36, 0.26), tone)


def plaster(u, v):
    return mix((0.86, 0.82, 0.74), (0.93, 0.90, 0.84), steps(clouds(u, v, 31, 4, 3), 20))


def stone(u, v):
    row = int(v * 4)
    x = (u * 2 + 0.5 * (row % 2)) % 2
    seam = (v * 4) % 1 < 0.02 or x % 1 < 0.01
    tone = steps(0.3 * hash01(int(x), row, 4) + 0.7 * clouds(u, v, 41, 8, 3), 20)
    return (0.55, 0.52, 0.47) if seam else mix((0.70, 0.66, 0.58), (0.84, 0.80, 0.72), tone)


def globe(u, v):
    """A planet: seas, land and ice, with lines of longitude and latitude."""
    angle, y = TAU * u, v
    height = clouds(u, v, 51, 4, 4) + 0.15 * math.sin(2 * angle) * math.sin(math.pi * y)
    line = (u * 24) % 1 < 0.03 or (v * 12) % 1 < 0.03
    if abs(v - 0.5) > 0.42:
        rgb = (0.93, 0.95, 0.97)
    elif height > 0.5:
        rgb = mix((0.25, 0.48, 0.18), (0.62, 0.52, 0.32), min(1, steps((height - 0.5) * 4, 10)))
    else:
        rgb = mix((0.05, 0.15, 0.40), (0.12, 0.36, 0.62), steps(height * 2, 10))
    return mix(rgb, (1, 1, 1), 0.35) if line else rgb


def painting_dunes(u, v):
    for k in range(7, 0, -1):
        edge = 0.1 * k + 0.06 * math.sin(TAU * (u * (1 + k % 3) + 0.37 * k))
        if v > edge:
            return mix((0.95, 0.75, 0.35), (0.15, 0.10, 0.35), k / 7)
    return (0.55, 0.20, 0.12)


def painting_julia(u, v):
    x, y = 3 * (u - 0.5), 3 * (v - 0.5)
    for n in range(40):
        x, y = x * x - y * y - 0.79, 2 * x * y + 0.15
        if x * x + y * y > 16:
            break
    t = steps(n / 39, 39)
    return (0.08 + 0.9 * t ** 0.6, 0.12 + 0.7 * t, 0.30 + 0.5 * t * (1 - t))


def painting_squares(u, v):
    palette = [(0.85, 0.16, 0.12), (0.95, 0.80, 0.15), (0.12, 0.25, 0.60), (0.93, 0.92, 0.88)]
    x0, y0, x1, y1, seed = 0.0, 0.0, 1.0, 1.0, 5
    for depth in range(6):
        cut = 0.3 + 0.4 * hash01(seed, depth, 61)
        if (x1 - x0) > (y1 - y0):
            middle = x0 + cut * (x1 - x0)
            if abs(u - middle) < 0.012:
                return (0.06, 0.06, 0.06)
            x0, x1, seed = (middle, x1, seed * 2 + 1) if u > middle else (x0, middle, seed * 2)
        else:
            middle = y0 + cut * (y1 - y0)
            if abs(v - middle) < 0.012:
                return (0.06, 0.06, 0.06)
            y0, y1, seed = (middle, y1, seed * 2 + 1) if v > middle else (y0, middle, seed * 2)
    return palette[int(hash01(seed, 3, 71) * 4) % 4]


# Models

class Model:
    def __init__(self):
        self.positions, self.normals, self.uvs, self.lines = [], [], [], []

    def vertex(self, p, n=None, uv=None):
        self.positions.append(p)
        self.normals.append(n)
        self.uvs.append(uv)
        return len(self.positions)

    def face(self, *corners):
        def name(i):
            t = str(i) if self.uvs[i - 1] is not None else ""
            n = str(i) if self.normals[i - 1] is not None else ""
            return f"{i}/{t}/{n}" if n else f"{i}/{t}" if t else str(i)
        self.lines.append("f " + " ".join(name(i) for i in corners))

    def material(self, name):
        self.lines.append("usemtl " + name)

    def grid(self, rows, columns, point, uv=None, smooth=True):
        """A sheet of rows x columns quads; point(s, t) for s, t in 0..1, normal by differences:
        d/ds x d/dt points outward."""
        first = len(self.positions) + 1
        h = 1e-4
        for i in range(rows + 1):
            for j in range(columns + 1):
                s, t = i / rows, j / columns
                normal = None
                if smooth:
                    a = sub(point(s + h, t), point(s - h, t))
                    b = sub(point(s, t + h), point(s, t - h))
                    normal = unit(cross(a, b))
                self.vertex(point(s, t), normal, uv(s, t) if uv else None)
        at = lambda i, j: first + i * (columns + 1) + j
        for i in range(rows):
            for j in range(columns):
                self.face(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1))

    def quad(self, a, b, c, d, uvs=None):
        """Corners counter-clockwise seen from the front."""
        uvs = uvs or [None] * 4
        self.face(*(self.vertex(p, None, uv) for p, uv in zip((a, b, c, d), uvs)))

    def box(self, low, high):
        (x0, y0, z0), (x1, y1, z1) = low, high
        self.quad((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
        self.quad((x1, y0, z0), (x0, y0, z0), (x0, y1, z0), (x1, y1, z0))
        self.quad((x1, y0, z1), (x1, y0, z0), (x1, y1, z0), (x1, y1, z1))
        self.quad((x0, y0, z0), (x0, y0, z1), (x0, y1, z1), (x0, y1, z0))
        self.quad((x0, y1, z1), (x1, y1, z1), (x1, y1, z0), (x0, y1, z0))
        self.quad((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))

    def turned(self, profile, columns):
        """A surface of revolution about Y; profile is (radius, y) from bottom to top."""
        for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
            slope = unit((y1 - y0, r0 - r1, 0)) if (r0, y0) != (r1, y1) else (1, 0, 0)
            first = len(self.positions) + 1
            for r, y in ((r0, y0), (r1, y1)):
                for j in range(columns + 1):
                    c, s = math.cos(TAU * j / columns), math.sin(TAU * j / columns)
                    self.vertex((r * c, y, -r * s), (slope[0] * c, slope[1], -slope[0] * s))
            for j in range(columns):
                a, b = first + j, first + columns + 1 + j
                self.face(a, a + 1, b + 1, b)

    def turned_at(self, place, profile, columns, upright=False):
        """The same somewhere else; upright turns its axis from +Y to +X."""
        first = len(self.positions)
        self.turned(profile, columns)
        turn = lambda p: (p[1], -p[0], p[2]) if upright else p
        for k in range(first, len(self.positions)):
            self.positions[k] = tuple(a + b for a, b in zip(turn(self.positions[k]), place))
            self.normals[k] = turn(self.normals[k])

    def write(self, name, library=None):
        def row(kind, values):
            return kind + "".join(" %s" % trim(v) for v in values)
        order = {"v": {}, "vt": {}, "vn": {}}

        def number(kind, values):
            if values is None:
                return ""
            return order[kind].setdefault(row(kind, values), len(order[kind]) + 1)
        refs = [(number("v", p), number("vt", t), number("vn", n))
                for p, t, n in zip(self.positions, self.uvs, self.normals)]
        lines = ["# made by scripts/make_assets.py"]
        if library:
            lines.append("mtllib " + library)
        for kind in ("v", "vt", "vn"):
            lines += order[kind]
        for line in self.lines:
            if line.startswith("f "):
                corners = []
                for word in line[2:].split():
                    v, t, n = refs[int(word.split("/")[0]) - 1]
                    corner = f"{v}/{t}/{n}" if n else f"{v}/{t}" if t else str(v)
                    # Quads at a pole shrink to triangles, or to nothing.
                    if all(c.split("/")[0] != str(v) for c in corners):
                        corners.append(corner)
                if len(corners) < 3:
                    continue
                line = "f " + " ".join(corners)
            lines.append(line)
        with open(os.path.join(SCENES, "models", name), "w", newline="\n") as out:
            out.write("\n".join(lines) + "\n")


def trim(value):
    text = ("%.4f" % value).rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a)) or 1
    return tuple(x / length for x in a)


def tube(curve, radius):
    """The surface around a closed curve: point(s, t) along it and around it."""
    def point(s, t):
        h = 1e-3
        at, before, after = curve(s), curve(s - h), curve(s + h)
        tangent = unit(sub(after, before))
        bend = tuple(a + b - 2 * c for a, b, c in zip(after, before, at))
        binormal = unit(cross(tangent, bend))
        normal = cross(binormal, tangent)
        c, d = math.cos(TAU * t), math.sin(TAU * t)
        return tuple(p + radius * (c * n + d * b) for p, n, b in zip(at, normal, binormal))
    return point


def make_knot():
    def curve(s):
        a = TAU * s
        r = 0.30 + 0.12 * math.cos(3 * a)
        return (r * math.cos(2 * a), 0.42 + 0.14 * math.sin(3 * a), r * math.sin(2 * a))
    model = Model()
    model.grid(320, 20, tube(curve, 0.055))
    model.write("knot.obj")


def make_vase():
    def point(s, t):
        y = 0.7 * s
        r = 0.10 + 0.11 * math.sin(math.pi * (0.15 + 0.95 * s)) ** 2 + 0.03 * s ** 6
        r *= 1 + 0.05 * math.cos(12 * TAU * t) * math.sin(math.pi * s)
        return (r * math.cos(TAU * t), y, r * math.sin(TAU * t))
    model = Model()
    model.grid(36, 96, lambda s, t: point(s, -t))
    # The inside, so that one sees a wall and not through it.
    model.grid(18, 48, lambda s, t: tuple(
        c * k for c, k in zip(point(0.12 + 0.88 * s, t), (0.93, 1, 0.93))))
    model.write("vase.obj")


def make_figure():
    """A twisted superellipsoid, 1.1 m tall."""
    def power(x, e):
        return math.copysign(abs(x) ** e, x)

    def point(s, t):
        a, b = math.pi * (s - 0.5), TAU * t
        e = 0.7
        r = 0.26 * power(math.cos(a), e)
        twist = 2.2 * s
        x, z = r * power(math.cos(b), e), r * power(math.sin(b), e) * 0.7
        c, d = math.cos(twist), math.sin(twist)
        return (x * c - z * d, 0.56 + 0.55 * power(math.sin(a), 0.8), x * d + z * c)

    def capped(s, t):
        return point(min(max(s, 1e-3), 1 - 1e-3), -t)
    model = Model()
    model.grid(60, 72, capped)
    model.write("figure.obj")


def make_pedestal():
    model = Model()
    model.box((-0.32, 0.0, -0.32), (0.32, 0.10, 0.32))
    model.box((-0.26, 0.10, -0.26), (0.26, 0.90, 0.26))
    model.box((-0.31, 0.90, -0.31), (0.31, 1.00, 0.31))
    model.write("pedestal.obj")


def make_column():
    """A fluted column, 4 m tall."""
    def shaft(s, t):
        swell = 0.30 * (1 - 0.15 * s * s)
        ends = min(1, 24 * s, 24 * (1 - s))
        flute = abs(math.sin(10 * TAU * t))
        r = swell * (1 - 0.07 * max(0, ends) * flute)
        return (r * math.cos(TAU * t), 0.35 + 3.25 * s, -r * math.sin(TAU * t))
    model = Model()
    model.grid(24, 120, lambda s, t: shaft(min(max(s, 0), 1), t))
    model.box((-0.42, 0, -0.42), (0.42, 0.12, 0.42))
    model.turned([(0.40, 0.12)] + [
        (0.34 + 0.06 * math.cos(a), 0.19 + 0.07 * math.sin(a))
        for a in (math.pi * (k / 8 - 0.5) for k in range(9))] + [(0.31, 0.30), (0.31, 0.36)], 48)
    model.turned([(0.26, 3.58), (0.28, 3.62), (0.27, 3.68)] + [
        (0.27 + 0.13 * math.sin(a), 3.84 - 0.16 * math.cos(a))
        for a in (math.pi / 2 * k / 8 for k in range(9))], 48)
    model.box((-0.42, 3.84, -0.42), (0.42, 4.0, 0.42))
    model.write("column.obj")


MATERIALS = """\
# made by scripts/make_assets.py
newmtl floor
Kd 1 1 1
Ks 0.12 0.12 0.12
Ns 60
illum 3
map_Kd ../textures/checker.png

newmtl plaster
Kd 1 1 1
illum 1
map_Kd ../textures/plaster.png

newmtl stone
Kd 1 1 1
illum 1
map_Kd ../textures/stone.png

newmtl rib
Kd 0.78 0.74 0.66
illum 1

newmtl gold
Kd 0.55 0.40 0.12
Ks 0.5 0.4 0.2
Ns 40
illum 2

newmtl dunes
Kd 0.9 0.9 0.9
illum 1
map_Kd ../textures/dunes.png

newmtl julia
Kd 0.9 0.9 0.9
illum 1
map_Kd ../textures/julia.png

newmtl squares
Kd 0.9 0.9 0.9
illum 1
map_Kd ../textures/squares.png
"""

BAY = 4.0          # columns stand this far apart along the hall
BAYS = 5
HALF_NAVE = 3.0    # the arcades' planes are at x = +-3
HALF_HALL = 5.5    # the outer walls
SPRING = 4.0       # height of the columns
AISLE = 6.0        # height of the aisles
ROTUNDA = 6.0      # radius of the round room
CENTER = -BAY * BAYS - 0.6 - math.sqrt(ROTUNDA ** 2 - 1.5 ** 2)


def make_arcade():
    """One bay: an arch of radius 1.58 between two columns at z = 0 and z = -4, 0.6 m thick, and
    the wall above it up to the aisle's ceiling."""
    model = Model()
    model.material("stone")
    radius, middle, half = 1.58, -BAY / 2, 0.3
    n = 32

    def rim(k):
        a = math.pi * k / n
        return (SPRING + radius * math.sin(a), middle + radius * math.cos(a))
    outline = lambda k: (AISLE, BAY * (k / n) * -1)
    for side in (-1, 1):
        x = side * half
        for k in range(n):
            (y0, z0), (y1, z1) = rim(k), rim(k + 1)
            (ya, za), (yb, zb) = outline(k), outline(k + 1)
            corners = [(x, y0, z0), (x, y1, z1), (x, yb, zb), (x, ya, za)]
            uvs = [(z / 2, y / 2) for _, y, z in corners]
            if side < 0:
                corners, uvs = corners[::-1], uvs[::-1]
            model.quad(*corners, uvs)
        # The feet beside the arch, on the capitals.
        for za, zb in ((0, middle + radius), (middle - radius, -BAY)):
            corners = [(x, SPRING, za), (x, SPRING, zb), (x, AISLE, zb), (x, AISLE, za)]
            corners = corners[:2] + [(x, SPRING, zb), (x, AISLE, 0 if za == 0 else -BAY)]
            model.face(*(model.vertex(p, None, (p[2] / 2, p[1] / 2)) for p in
                         (corners[0], corners[1], corners[3])))
    model.material("rib")
    model.grid(n, 1, lambda s, t: (
        half * (2 * t - 1), SPRING + radius * math.sin(math.pi * s),
        middle + radius * math.cos(math.pi * s)))
    model.write("arcade.obj", "gallery.mtl")


def make_hall():
    length = BAY * BAYS
    model = Model()
    h, end = HALF_HALL, -length
    model.material("floor")
    model.quad((-h, 0, 2), (h, 0, 2), (h, 0, end), (-h, 0, end),
               [(x / 4, z / 4) for x, z in ((-h, 2), (h, 2), (h, end), (-h, end))])
    model.material("stone")
    for side in (-1, 1):
        x = side * h
        corners = [(x, 0, 2), (x, 0, end), (x, AISLE, end), (x, AISLE, 2)]
        model.quad(*corners, [(z / 2, y / 2) for _, y, z in corners])
    model.material("plaster")
    for side in (-1, 1):
        a, b = side * HALF_NAVE, side * h
        corners = [(a, AISLE, 2), (b, AISLE, 2), (b, AISLE, end), (a, AISLE, end)]
        model.quad(*corners, [(x / 4, z / 4) for x, _, z in corners])
    # The barrel vault, with a rib over every column.
    model.grid(48, 44, lambda s, t: (
        HALF_NAVE * math.cos(math.pi * s), AISLE + HALF_NAVE * math.sin(math.pi * s),
        2 + (end - 2) * t), lambda s, t: (s * 3, t * 6))
    model.material("rib")
    for k in range(BAYS + 1):
        def rib(s, t, z=-BAY * k):
            a, b = math.pi * s, TAU * t
            r = HALF_NAVE + 0.02 - 0.14 * math.cos(b) * (math.cos(b) > 0)
            return (r * math.cos(a), AISLE + r * math.sin(a), z + 0.2 * math.sin(b))
        model.grid(64, 16, rib)
    for side in (-1, 1):
        def cornice(s, t, side=side):
            r = 0.12
            return (side * (HALF_NAVE - 0.3) - side * r * math.sin(math.pi * t),
                    AISLE - 0.12 + r * math.cos(math.pi * t), 2 + (end - 2) * s)
        model.grid(40, 12, cornice)
    # End walls: behind, closed; ahead, with a round-headed door.
    model.material("plaster")
    top = AISLE + HALF_NAVE
    model.quad((h, 0, 2), (-h, 0, 2), (-h, top, 2), (h, top, 2),
               [(0, 0), (3, 0), (3, 3), (0, 3)])
    doorway(model, h, top, end, 1)
    doorway(model, h, top, end - 0.6, -1)
    model.material("rib")
    path = door_outline(24)
    for (x0, y0), (x1, y1) in zip(path, path[1:]):
        model.quad((x0, y0, end), (x1, y1, end), (x1, y1, end - 0.6), (x0, y0, end - 0.6))
    model.material("floor")
    far = CENTER - ROTUNDA
    model.quad((-7, 0, end), (7, 0, end), (7, 0, far - 0.5), (-7, 0, far - 0.5),
               [(x / 4, z / 4) for x, z in ((-7, end), (7, end), (7, far - 0.5), (-7, far - 0.5))])
    # Pictures with golden frames on the outer walls.
    names = ["dunes", "julia", "squares"]
    for k in range(BAYS):
        for side in (-1, 1):
            z = -BAY * (k + 0.5)
            picture(model, side * (h - 0.02), 1.2, z, names[(k + (side > 0)) % 3])
    model.write("hall.obj", "gallery.mtl")


def door_outline(n):
    """Half-width 1.5, springing at 2.6, round above: from the left foot over the top."""
    arc = [(-1.5 * math.cos(math.pi * k / n), 2.6 + 1.5 * math.sin(math.pi * k / n))
           for k in range(n + 1)]
    return [(-1.5, 0)] + arc + [(1.5, 0)]


def doorway(model, half, top, z, facing):
    model.material("plaster")
    path = door_outline(24)
    outer = [(-half, 0)] + [
        (-half + 2 * half * k / 24, top) for k in range(25)] + [(half, 0)]
    for (a, b), (c, d) in zip(zip(path, path[1:]), zip(outer, outer[1:])):
        corners = [(*a, z), (*b, z), (*d, z), (*c, z)]
        if facing > 0:
            corners = corners[::-1]
        model.quad(*corners, [(x / 4, y / 4) for x, y, _ in corners])


def picture(model, x, y, z, name):
    """1.8 m wide, 1.4 m high, hung on the wall x, facing the nave."""
    inward = -1 if x > 0 else 1
    x += inward * 0.03
    corners = [(x, y, z + inward * 0.9), (x, y, z - inward * 0.9),
               (x, y + 1.4, z - inward * 0.9), (x, y + 1.4, z + inward * 0.9)]
    model.material(name)
    model.quad(*corners, [(0, 0), (1, 0), (1, 1), (0, 1)])
    model.material("gold")
    a, b = sorted((x - inward * 0.04, x + inward * 0.05))
    model.box((a, y - 0.1, z - 1.0), (b, y, z + 1.0))
    model.box((a, y + 1.4, z - 1.0), (b, y + 1.5, z + 1.0))
    model.box((a, y, z - 1.0), (b, y + 1.4, z - 0.9))
    model.box((a, y, z + 0.9), (b, y + 1.4, z + 1.0))


def make_rotunda():
    """A round room under a coffered dome, open towards the hall; its centre is the origin."""
    model = Model()
    model.material("stone")
    gap = math.asin(1.5 / ROTUNDA)

    def wall(s, t):
        # From the door's right side, all the way round to its left.
        a = gap + (TAU - 2 * gap) * t
        return (ROTUNDA * math.sin(a), 5.0 * s, ROTUNDA * math.cos(a))
    model.grid(4, 96, wall, lambda s, t: (t * 16, s * 2.5))
    # Above the door.
    def lintel(s, t):
        a = gap * (2 * t - 1)
        low = 2.6 + math.sqrt(max(0, 1.5 ** 2 - (ROTUNDA * math.sin(a)) ** 2))
        return (ROTUNDA * math.sin(a), low + (5.0 - low) * s, ROTUNDA * math.cos(a))
    model.grid(4, 24, lintel, lambda s, t: (t, s), smooth=False)
    model.material("rib")
    def cornice(s, t):
        r = ROTUNDA - 0.2 * math.sin(math.pi * t)
        return (r * math.sin(TAU * s), 5.0 + 0.2 * math.cos(math.pi * t), r * math.cos(TAU * s))
    model.grid(96, 12, cornice)

    def dome(s, t):
        a, b = math.pi / 2 * s, TAU * t
        across = (t * 16) % 1
        along = (s * 7) % 1
        coffer = s < 6 / 7 and 0.14 < across < 0.86 and 0.14 < along < 0.86
        r = ROTUNDA + (0.25 if coffer else 0)
        return (r * math.cos(a) * math.sin(b), 5.0 + 0.75 * r * math.sin(a),
                r * math.cos(a) * math.cos(b))
    model.material("plaster")
    model.grid(70, 256, dome, lambda s, t: (t * 16, s * 4), smooth=False)
    model.write("rotunda.obj", "gallery.mtl")


# The sunroom

# "lamp" is what glows on the wall: Ke.
SUNROOM_MATERIALS = """\
# made by scripts/make_assets.py
newmtl floor
Kd 1 1 1
Ks 0.05 0.05 0.05
illum 3
map_Kd ../textures/herringbone.png

newmtl plaster
Kd 0.82 0.80 0.76
illum 1

newmtl white
Kd 0.84 0.83 0.81
illum 1

newmtl teal
Kd 0.08 0.25 0.32
illum 1

newmtl oak
Kd 0.42 0.28 0.16
illum 1

newmtl rust
Kd 0.56 0.15 0.07
illum 1

newmtl cream
Kd 0.72 0.64 0.50
illum 1

newmtl blue
Kd 0.10 0.20 0.42
illum 1

newmtl ochre
Kd 0.66 0.42 0.09
illum 1

newmtl brass
Kd 0.35 0.24 0.08
Ks 0.45 0.33 0.14
illum 3

newmtl mirror
Kd 0.02 0.02 0.02
Ks 0.88 0.88 0.88
illum 3

newmtl clay
Kd 0.60 0.30 0.18
illum 1

newmtl leaf
Kd 0.10 0.28 0.06
illum 1

newmtl bark
Kd 0.22 0.15 0.10
illum 1

newmtl hedge
Kd 0.09 0.19 0.05
illum 1

newmtl lawn
Kd 0.15 0.25 0.07
illum 1

newmtl paving
Kd 0.52 0.47 0.39
illum 1

newmtl hills
Kd 0.20 0.27 0.30
illum 1

newmtl dunes
Kd 0.9 0.9 0.9
illum 1
map_Kd ../textures/dunes.png

newmtl lamp
Kd 0.8 0.8 0.8
Ke 2.2 1.1 0.36
illum 1
"""

# x = -3.2 to 3.2, y = 0 to 3.2, z = 0 to -8.4; the windows are at x = 3.2 and z = -8.4.
ROOM_X, ROOM_Y, ROOM_Z = 3.2, 3.2, 8.4
WALL = 0.35                             # thickness
SILL, ARCH, HALF_WINDOW = 0.45, 1.95, 0.7
SUN_WINDOWS = [1.9, 4.2, 6.5]           # their middles along the wall
END_WINDOW = 1.55                       # and that of the end wall's, in x


def window_outline(inset=0.0, n=24):
    """From the left foot over the round top to the right foot; x = 0 is the middle."""
    r = HALF_WINDOW - inset
    return ([(-r, SILL + inset)] +
            [(-r * math.cos(math.pi * k / n), ARCH + r * math.sin(math.pi * k / n))
             for k in range(n + 1)] + [(r, SILL + inset)])


def window_wall(model, place, length, middles, inside):
    """A wall with round-headed windows: place(u, y, depth) in space, u along it. The outer sheet is
    longer and higher than the inner one, so that it meets its neighbours and the roof."""
    path = window_outline()
    n = len(path) - 1
    ends = [0] + [(a + b) / 2 for a, b in zip(middles, middles[1:])] + [length]

    def sheet(low, high, depth):
        quad = lambda *corners: model.quad(*(place(u, y, depth) for u, y in corners))
        for middle, left, right in zip(middles, ends, ends[1:]):
            left -= WALL if depth and left == 0 else 0
            right += WALL if depth and right == length else 0
            stops = [left, middle - HALF_WINDOW, middle + HALF_WINDOW, right]
            for a, b in zip(stops, stops[1:]):
                quad((a, low), (b, low), (b, SILL), (a, SILL))
            top = [(left + (right - left) * k / (n - 2), high) for k in range(n - 1)]
            outer = [(left, SILL)] + top + [(right, SILL)]
            for (a, b), (c, d) in zip(zip(path, path[1:]), zip(outer, outer[1:])):
                quad((a[0] + middle, a[1]), (b[0] + middle, b[1]), d, c)
    model.material(inside)
    sheet(0, ROOM_Y, 0)
    model.material("plaster")
    sheet(-0.2, ROOM_Y + 0.1, WALL)
    model.material("white")
    for middle in middles:
        for a, b in zip(path, path[1:] + path[:1]):
            model.quad(*(place(middle + u, y, d) for (u, y), d in
                         ((a, 0), (b, 0), (b, WALL), (a, WALL))))
        # The board on the sill.
        low = place(middle - HALF_WINDOW - 0.1, SILL - 0.045, -0.12)
        high = place(middle + HALF_WINDOW + 0.1, SILL, 0)
        model.box(*zip(*(sorted(pair) for pair in zip(low, high))))


def make_window():
    """The frame and its bars, 6 cm deep, in the plane z = 0."""
    model = Model()
    deep = 0.03
    outer, inner = window_outline(), window_outline(0.07)
    for (a, b), (c, d) in zip(zip(outer, outer[1:] + outer[:1]), zip(inner, inner[1:] + inner[:1])):
        for z in (deep, -deep):
            model.quad((*a, z), (*c, z), (*d, z), (*b, z))
        model.quad((*c, deep), (*c, -deep), (*d, -deep), (*d, deep))
    r = HALF_WINDOW - 0.05
    model.box((-0.025, SILL + 0.05, -0.025), (0.025, ARCH + r, 0.025))
    for y in (SILL + 0.5, SILL + 1.0, ARCH):
        model.box((-r, y - 0.02, -0.02), (r, y + 0.02, 0.02))
    for angle in (45, 135):
        c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        corner = lambda along, across, z: (along * c - across * s, ARCH + along * s + across * c, z)
        bar = ((0, -0.02), (r, -0.02), (r, 0.02), (0, 0.02))
        for side in (-0.02, 0.02):
            model.quad(*(corner(along, across, side) for along, across in bar))
            model.quad(*(corner(along, side, z) for along, z in bar))
    model.write("sunroom_window.obj")


def make_chair():
    """It faces +Z."""
    model = Model()
    model.box((-0.22, 0.43, -0.21), (0.22, 0.47, 0.23))
    for x in (-0.2, 0.2):
        model.box((x - 0.02, 0, 0.18), (x + 0.02, 0.43, 0.22))
        model.box((x - 0.02, 0, -0.22), (x + 0.02, 0.88, -0.18))
    model.box((-0.18, 0.76, -0.21), (0.18, 0.88, -0.19))
    model.box((-0.18, 0.58, -0.21), (0.18, 0.64, -0.19))
    model.write("sunroom_chair.obj")


def make_cushion():
    """A rounded box from -1 to 1, plumper in the middle."""
    power = lambda x, e: math.copysign(abs(x) ** e, x)

    def point(s, t):
        a, b = math.pi * (s - 0.5), -TAU * t
        r = power(math.cos(a), 0.35)
        return (r * power(math.cos(b), 0.3), power(math.sin(a), 0.35), r * power(math.sin(b), 0.3))
    model = Model()
    model.grid(14, 28, point)
    model.write("sunroom_cushion.obj")


def make_tree():
    """4 m tall; the crown is of flat facets of uneven height, which look like leaves."""
    model = Model()
    model.material("bark")
    model.turned([(0.16, -0.2), (0.10, 0.6), (0.10, 1.9)], 10)
    model.material("hedge")

    def crown(s, t):
        a, b = math.pi * (s - 0.5), TAU * t
        r = 1.25 + 0.45 * (noise(t % 1, min(s, 0.999), 9, 81) - 0.5) * (0 < s < 1)
        wide = r * math.cos(a)
        return (wide * math.sin(b), 2.7 + 1.05 * r * math.sin(a), wide * math.cos(b))
    model.grid(18, 28, crown, smooth=False)
    model.write("sunroom_tree.obj", "sunroom.mtl")


def make_plant():
    """A pot with long leaves that bend over."""
    model = Model()
    model.material("clay")
    model.turned([(0, 0), (0.15, 0), (0.21, 0.36), (0.23, 0.36), (0.23, 0.41), (0.20, 0.41),
                  (0.19, 0.33)], 32)
    model.material("bark")
    model.turned([(0.2, 0.33), (0, 0.36)], 32)
    model.material("leaf")
    for k in range(17):
        turn = 2.4 * k                      # the golden angle, nearly
        long = 0.75 + 0.65 * hash01(k, 1, 91)
        bend = 0.5 + 1.1 * hash01(k, 2, 91)

        def leaf(s, t, turn=turn, long=long, bend=bend):
            lean = 0.12 + bend * s
            out = 0.03 + long * s * math.sin(lean) * 0.8
            y = 0.34 + long * s * math.cos(lean * 0.75)
            wide = 0.12 * math.sin(math.pi * (0.08 + 0.92 * s) ** 0.8) * (2 * t - 1)
            y += 0.25 * abs(wide)           # a fold along the middle
            return (out * math.cos(turn) - wide * math.sin(turn), y,
                    out * math.sin(turn) + wide * math.cos(turn))
        model.grid(12, 4, leaf)
    model.write("sunroom_plant.obj", "sunroom.mtl")


def make_sunroom():
    model = Model()
    x, y, z = ROOM_X, ROOM_Y, -ROOM_Z
    model.material("floor")
    model.quad((-x, 0, 0), (x, 0, 0), (x, 0, z), (-x, 0, z),
               [((a + b) / 2, (a - b) / 2) for a, b in ((-x, 0), (x, 0), (x, z), (-x, z))])
    model.material("white")
    model.quad((-x, y, z), (x, y, z), (x, y, 0), (-x, y, 0))
    # The closed walls; the roof and the walls' outer sides, so that light has one way in.
    model.material("plaster")
    model.quad((-x, 0, 0), (-x, 0, z), (-x, y, z), (-x, y, 0))
    model.quad((x, 0, 0), (-x, 0, 0), (-x, y, 0), (x, y, 0))
    model.box((-x - WALL, -0.2, WALL), (x + WALL, y + 0.1, WALL + 0.02))
    model.box((-x - WALL - 0.02, -0.2, z - WALL), (-x - WALL, y + 0.1, WALL + 0.02))
    model.material("oak")
    model.box((-x - 0.5, y + 0.1, z - 0.5), (x + 0.5, y + 0.3, 0.5))
    window_wall(model, lambda u, h, d: (x + d, h, -u), ROOM_Z, SUN_WINDOWS, "plaster")
    window_wall(model, lambda u, h, d: (u - x, h, z - d), 2 * x, [END_WINDOW + x], "teal")
    # Beams, and boards at the feet of the walls.
    model.material("oak")
    for k in range(7):
        model.box((-x, y - 0.2, -0.66 - 1.18 * k), (x, y, -0.54 - 1.18 * k))
    model.material("white")
    model.box((-x, 0, z), (-x + 0.02, 0.11, 0))
    model.box((x - 0.02, 0, z), (x, 0.11, 0))
    model.box((-x + 0.02, 0, z), (x - 0.02, 0.11, z + 0.02))
    sunroom_furniture(model)
    sunroom_garden(model)
    model.write("sunroom.obj", "sunroom.mtl")


def sunroom_furniture(model):
    x, z = ROOM_X, -ROOM_Z
    # The rug, and a round table on it.
    model.material("cream")
    model.box((-2.1, 0, -4.5), (0.6, 0.010, -1.3))
    model.material("rust")
    model.box((-1.98, 0.010, -4.38), (0.48, 0.016, -1.42))
    model.material("ochre")
    for c in (-4.1, -3.98, -1.84, -1.72):
        model.box((-1.98, 0.016, c), (0.48, 0.018, c + 0.04))
    model.material("oak")
    model.turned_at((-0.75, 0, -2.9), [
        (0, 0.016), (0.26, 0.016), (0.26, 0.04), (0.05, 0.07), (0.045, 0.38), (0.36, 0.38),
        (0.38, 0.39), (0.38, 0.41), (0.36, 0.42), (0, 0.42)], 48)
    # The dining table, and a bowl on it.
    model.box((-0.35, 0.70, -7.15), (0.65, 0.75, -5.25))
    for a in (-0.28, 0.52):
        for b in (-7.08, -5.38):
            model.box((a, 0, b), (a + 0.06, 0.70, b + 0.06))
    model.material("cream")
    model.turned_at((0.1, 0.75, -5.7), [
        (0, 0.002), (0.06, 0.002), (0.12, 0.04), (0.15, 0.09), (0.142, 0.09), (0.11, 0.045),
        (0, 0.02)], 40)
    # The shelf, books, jugs.
    model.material("oak")
    deep, a, b = -x + 0.32, -7.9, -5.7
    for h in (0.11, 0.55, 0.99, 1.43, 1.87):
        model.box((-x + 0.001, h, a), (deep, h + 0.03, b))
    for c in (a, (a + b) / 2 - 0.015, b - 0.03):
        model.box((-x + 0.001, 0, c), (deep - 0.001, 1.95, c + 0.03))
    colors = ["rust", "blue", "cream", "ochre", "teal", "white"]
    for shelf, (first, count) in enumerate([(-7.85, 15), (-6.75, 11), (-7.4, 9)]):
        h, at = (0.14, 0.58, 1.46)[shelf], first
        for k in range(count):
            wide = 0.025 + 0.025 * hash01(k, shelf, 101)
            model.material(colors[int(6 * hash01(k, shelf, 102)) % 6])
            front = deep - 0.05 - 0.04 * hash01(k, shelf, 103)
            top = h + 0.24 + 0.12 * hash01(k, shelf, 104)
            model.box((-x + 0.05, h, at), (front, top, at + wide - 0.002))
            at += wide
    jug = [(0, 0), (0.06, 0), (0.10, 0.09), (0.10, 0.14), (0.045, 0.21), (0.04, 0.26),
           (0.055, 0.29), (0.035, 0.26), (0.03, 0.1)]
    for color, c, h in (("rust", -7.2, 0.14), ("blue", -7.6, 1.02), ("cream", -7.25, 1.02),
                        ("teal", -6.1, 1.46)):
        model.material(color)
        model.turned_at((-x + 0.17, h, c), jug, 28)
    # A round mirror over the sofa.
    model.material("brass")
    middle = (-x, 1.62, -2.9)
    model.turned_at(middle, [(0.56, 0.001), (0.58, 0.03), (0.54, 0.04), (0.52, 0.02)], 64, True)
    model.material("mirror")
    model.turned_at(middle, [(0.53, 0.02), (0, 0.02)], 64, True)
    # A picture on the end wall between two lamps.
    picture_frame(model, (-1.7, 1.25, z), 1.2, 1.0, "dunes")
    for c in (-2.55, -0.85):
        model.material("brass")
        model.box((c - 0.07, 1.58, z), (c + 0.07, 1.92, z + 0.03))
        model.material("lamp")
        front = z + 0.031
        model.quad((c - 0.05, 1.6, front), (c + 0.05, 1.6, front),
                   (c + 0.05, 1.9, front), (c - 0.05, 1.9, front))
    # A low chest under the picture.
    model.material("oak")
    model.box((-2.3, 0.12, z + 0.02), (-1.1, 0.62, z + 0.43))
    for c in (-2.29, -1.695):
        model.box((c, 0.13, z + 0.43), (c + 0.585, 0.61, z + 0.45))
    model.material("bark")
    model.box((-2.25, 0, z + 0.06), (-1.15, 0.12, z + 0.40))
    # The pendant's cord.
    model.box((0.196, 1.9, -6.204), (0.204, ROOM_Y, -6.196))
    model.material("brass")
    model.turned_at((0.2, 1.7, -6.2), [
        (0.10, 0.16), (0.105, 0.17), (0.05, 0.22), (0.015, 0.25), (0, 0.25)], 32)


def picture_frame(model, middle_foot, width, height, name):
    """Hung on an end wall, facing +Z."""
    x, y, z = middle_foot
    a, b, c = x - width / 2, x + width / 2, y + height
    model.material(name)
    model.quad((a, y, z + 0.02), (b, y, z + 0.02), (b, c, z + 0.02), (a, c, z + 0.02),
               [(0, 0), (1, 0), (1, 1), (0, 1)])
    model.material("oak")
    model.box((a - 0.05, y - 0.05, z), (b + 0.05, y, z + 0.04))
    model.box((a - 0.05, c, z), (b + 0.05, c + 0.05, z + 0.04))
    model.box((a - 0.05, y, z), (a, c, z + 0.04))
    model.box((b, y, z), (b + 0.05, c, z + 0.04))


def sunroom_garden(model):
    """What the windows show: a terrace, a lawn between hedges, hills."""
    x, z = ROOM_X + WALL, -ROOM_Z - WALL
    model.material("paving")
    model.box((-x, -0.3, z - 3.5), (x + 3.0, -0.12, z))
    model.box((x, -0.3, z), (x + 3.0, -0.12, 3))
    model.material("lawn")
    ring = [(170 * math.cos(TAU * k / 24), -0.15, -170 * math.sin(TAU * k / 24)) for k in range(24)]
    model.face(*(model.vertex(p) for p in ring))

    def hedge(start, end):
        """1.2 m tall, of flat facets of uneven height."""
        def point(s, t):
            bump = 0.24 * (noise(s % 1, min(t, 0.999), 60, 111) - 0.5)
            a, r = math.pi * t, 0.5 + bump
            along = (start[0] + (end[0] - start[0]) * s, start[1] + (end[1] - start[1]) * s)
            side = unit((start[1] - end[1], end[0] - start[0], 0))
            off = r * math.copysign(abs(math.cos(a)) ** 0.4, math.cos(a))
            return (along[0] + off * side[0], -0.2 + 1.25 * math.sin(a) ** 0.4 + bump * math.sin(a),
                    along[1] + off * side[1])
        model.grid(110, 8, point, smooth=False)
    model.material("hedge")
    hedge((-14, -22), (16, -22))
    hedge((16, -22), (16, 6))
    model.material("hills")

    def hills(s, t):
        a = TAU * s
        h = 13 + 6 * math.sin(5 * a + 1) + 3 * math.sin(11 * a) + 1 * math.sin(23 * a + 2)
        return ((170 - 25 * (1 - t)) * math.sin(a), -1 + h * t, (170 - 25 * (1 - t)) * math.cos(a))
    model.grid(160, 2, hills)


def main():
    for folder in ("models", "textures"):
        os.makedirs(os.path.join(SCENES, folder), exist_ok=True)
    write_png("checker.png", 256, checker)
    write_png("wood.png", 256, wood)
    write_png("herringbone.png", 320, herringbone)
    write_png("bricks.png", 256, bricks)
    write_png("plaster.png", 256, plaster)
    write_png("stone.png", 256, stone)
    write_png("globe.png", 384, globe)
    write_png("dunes.png", 256, painting_dunes)
    write_png("julia.png", 256, painting_julia)
    write_png("squares.png", 256, painting_squares)
    with open(os.path.join(SCENES, "models", "gallery.mtl"), "w", newline="\n") as out:
        out.write(MATERIALS)
    make_knot()
    make_vase()
    make_figure()
    make_pedestal()
    make_column()
    make_arcade()
    make_hall()
    make_rotunda()
    with open(os.path.join(SCENES, "models", "sunroom.mtl"), "w", newline="\n") as out:
        out.write(SUNROOM_MATERIALS)
    make_window()
    make_chair()
    make_cushion()
    make_tree()
    make_plant()
    make_sunroom()


if __name__ == "__main__":
    main()
