"""What an SVG of `stance plot` shows: texts, frames, tics, marks, lines, areas, images, in its order.

Values are read off by the tics, as people do: `Picture.panel(k)` has x(px) and y(px), from the places of
its tics' labels, on the scale, linear or log, that the caller expects: any other does not fit.
"""
import base64
import html
import math
import re
import struct
import zlib

import numpy as np

NUMBER = r"-?[\d.]+"


def colour(text):
    """'rgb(0, 114, 178)', '#0072B2' or a name as '0072b2'."""
    if text.startswith("#"):
        return text[1:].lower()
    found = re.findall(r"\d+", text)
    return "".join(f"{int(c):02x}" for c in found) if found else {"black": "000000", "white": "ffffff"}[text]


def png(data):
    """Pixels [row][column][rgba], 0 ... 255, of a PNG without interlacing."""
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    chunks, place = b"", 8
    while place < len(data):
        size = struct.unpack(">I", data[place:place + 4])[0]
        if data[place + 4:place + 8] == b"IDAT":
            chunks += data[place + 8:place + 8 + size]
        place += size + 12
    channels = {0: 1, 2: 3, 4: 2, 6: 4}[kind]
    assert depth == 8
    raw, line = zlib.decompress(chunks), width * channels
    pixels = np.zeros((height, line), int)
    for j in range(height):
        kind_of, row = raw[j * (line + 1)], np.frombuffer(raw, np.uint8, line, j * (line + 1) + 1).astype(int)
        up = pixels[j - 1] if j else np.zeros(line, int)
        for i in range(line):
            a, b = (pixels[j][i - channels] if i >= channels else 0), up[i]
            c = up[i - channels] if i >= channels else 0
            p = a + b - c
            paeth = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            pixels[j][i] = (row[i] + (0, a, b, (a + b) // 2, paeth)[kind_of]) % 256
    pixels = pixels.reshape(height, width, channels)
    return pixels if channels == 4 else np.dstack([pixels, np.full((height, width), 255)])


def gif(data):
    """Colours [row][column][rgb] of the first frame of a GIF, which fills it."""
    width, height, flags = struct.unpack("<HHB", data[6:11])
    place = 13 + 3 * (2 << (flags & 7))
    colours = np.frombuffer(data, np.uint8, place - 13, 13).reshape(-1, 3)
    while data[place] == 0x21: # extensions
        place += 2
        while data[place]:
            place += data[place] + 1
        place += 1
    assert data[place] == 0x2c and struct.unpack("<4H", data[place + 1:place + 9]) == (0, 0, width, height)
    if data[place + 9] & 0x80:
        count = 2 << (data[place + 9] & 7)
        colours = np.frombuffer(data, np.uint8, 3 * count, place + 10).reshape(-1, 3)
        place += 3 * count
    least, place, packed = data[place + 10], place + 11, b""
    while data[place]:
        packed += data[place + 1:place + 1 + data[place]]
        place += data[place] + 1
    bits, held, at, pixels, clear = 0, 0, 0, bytearray(), 1 << least
    table, size, last = [], least + 1, b""
    while len(pixels) < width * height: # LZW: codes of growing width, least significant bits first
        while held < size:
            bits |= packed[at] << held
            held, at = held + 8, at + 1
        code, bits, held = bits & ((1 << size) - 1), bits >> size, held - size
        if code == clear:
            table, size, last = [bytes([k]) for k in range(clear)] + [b"", b""], least + 1, b""
            continue
        word = table[code] if code < len(table) else last + last[:1]
        if last:
            table.append(last + word[:1])
        if len(table) == 1 << size and size < 12:
            size += 1
        pixels += word
        last = word
    return colours[np.frombuffer(bytes(pixels), np.uint8)].reshape(height, width, 3)


class Panel:
    """A frame with what was drawn since; `x` and `y` turn px into values."""

    def __init__(self, frame, picture):
        self.left, self.top, self.right, self.bottom = frame
        self.points, self.lines, self.areas, self.images = [], [], [], []
        self.picture = picture

    def scale(self, axis, log):
        """The map from px to values of the axis 0 or 1, by the tics of this panel or those in line with it."""
        ends = [(self.left, self.right), (self.top, self.bottom)][axis]
        tics = {}
        for along, at, edge, text in self.picture.tics:
            on_edge = abs(edge - (self.bottom, self.left)[axis]) < 0.1
            aligned = any(abs(edge - (p.bottom, p.left)[axis]) < 0.1 and
                          abs([p.left, p.top][axis] - ends[0]) < 0.1 for p in self.picture.panels)
            if along == axis and ends[0] - 0.1 <= at <= ends[1] + 0.1 and (on_edge or aligned) and text:
                tics.setdefault(on_edge, {})[at] = text
        tics = tics.get(True) or tics.get(False)
        assert tics and len(tics) >= 2, ("fewer than two tics", axis, tics)
        places = np.array(list(tics))
        values = np.array([float(t) for t in tics.values()])
        line = np.polyfit(places, np.log10(values) if log else values, 1)
        off = np.abs(np.polyval(line, places) - (np.log10(values) if log else values)).max() / abs(line[0])
        assert off < 0.6, ("tics are not on this scale", axis, tics)
        return lambda px: 10**np.polyval(line, px) if log else np.polyval(line, px)

    def x(self, px, log=False):
        return self.scale(0, log)(np.asarray(px))

    def y(self, px, log=False):
        return self.scale(1, log)(np.asarray(px))

    def range(self, axis, log=False):
        ends = ((self.left, self.right), (self.bottom, self.top))[axis]
        return [float(self.scale(axis, log)(e)) for e in ends]

    def words(self, axis):
        """Labels of the axis's tics with their places."""
        edge = (self.bottom, self.left)[axis]
        ends = [(self.left, self.right), (self.top, self.bottom)][axis]
        return [(at, t) for along, at, e, t in self.picture.tics
                if along == axis and abs(e - edge) < 0.1 and ends[0] <= at <= ends[1]]

    def marks(self, *colours):
        """Points of those colours, [n][2] px."""
        return np.array([(x, y) for x, y, c, _, _ in self.points if not colours or c in colours])


class Picture:
    def __init__(self, path):
        with open(path, encoding="utf-8") as file:
            text = file.read()
        self.texts, self.tics, self.panels, self.bars = [], [], [], []
        panel = Panel((0, 0, 0, 0), self) # of the page
        self.page = panel
        last_tic = None
        body = text[text.index("</defs>"):]
        item = re.compile(
            r"<path stroke='(?P<stroke>[^']*)'(?P<more>[^>]*?)d='(?P<d>[^']*)'|"
            r"<use xlink:href='#gpPt(?P<type>\d+)' transform='translate\((?P<ux>[^,]*),(?P<uy>[^)]*)\) scale\((?P<us>[^)]*)\)' color='(?P<uc>[^']*)'|"
            r"<polygon fill = '(?P<fill>[^']*)'[^>]*points = '(?P<polygon>[^']*)'|"
            r"<image [^>]*?x='(?P<ix>[^']*)' y='(?P<iy>[^']*)' width='(?P<iw>[^']*)' height='(?P<ih>[^']*)'[^>]*base64,(?P<data>[^']*)'|"
            r"<g transform=\"translate\((?P<tx>[^,]*),(?P<ty>[^)]*)\)(?P<turn>[^\"]*)\"[^>]*font-size=\"(?P<size>[^\"]*)\"[^>]*>\s*<text[^>]*>(?P<text>.*?)</text>|"
            r"<text[^>]*>(?P<more_text>.*?)</text>", re.S)
        for m in item.finditer(body):
            if m["d"]:
                parts = [[tuple(map(float, p.split(","))) for p in re.findall(rf"{NUMBER},{NUMBER}", part)]
                         for part in m["d"].split("M")[1:]]
                points, stroke = parts[0], colour(m["stroke"])
                if stroke == "404040" and len(points) == 5 and "Z" in m["d"]:
                    xs, ys = zip(*points)
                    frame = (min(xs), min(ys), max(xs), max(ys))
                    if min(frame[2] - frame[0], frame[3] - frame[1]) < 25:
                        self.bars.append(frame) # of colours
                        continue
                    same = [p for p in self.panels if np.allclose((p.left, p.top, p.right, p.bottom), frame, atol=0.1)]
                    if not same:
                        self.panels.append(Panel(frame, self))
                    panel = same[0] if same else self.panels[-1]
                elif stroke == "404040" and len(points) == 2 and abs(math.dist(*points) - 5.4) < 0.3:
                    upright = points[0][0] == points[1][0]
                    last_tic = (0, points[0][0], points[0][1]) if upright else (1, points[0][1], points[0][0])
                    continue
                elif "gridline" not in m["more"]:
                    panel.lines += [(stroke, "dasharray" in m["more"], part) for part in parts]
            elif m["uc"]:
                panel.points.append((float(m["ux"]), float(m["uy"]), colour(m["uc"]), int(m["type"]), float(m["us"])))
            elif m["polygon"]:
                points = [tuple(map(float, p.split(","))) for p in m["polygon"].split()]
                panel.areas.append((colour(m["fill"]), points))
            elif m["data"]:
                image = (*(float(m[k]) for k in ("ix", "iy", "iw", "ih")), png(base64.b64decode(m["data"])))
                panel.images.append(image)
            elif m["text"] is not None:
                text = html.unescape(m["text"])
                if last_tic:
                    self.tics.append((*last_tic, text))
                else:
                    self.texts.append((float(m["tx"]), float(m["ty"]), text, "rotate" in m["turn"]))
            elif m["more_text"] is not None:
                self.texts.append((None, None, html.unescape(m["more_text"]), False))
            last_tic = None
        # An image stands before the frame that it fills.
        for p in [self.page] + self.panels[:]:
            for image in p.images[:]:
                home = [q for q in self.panels if abs(q.left - image[0]) < 1 and abs(q.top - image[1]) < 1]
                if home and home[0] is not p:
                    p.images.remove(image)
                    home[0].images.append(image)

    def said(self):
        return [t for _, _, t, _ in self.texts]

    def bar(self):
        """The values at the ends of the colour bar, by the numbers beside it."""
        left, top, right, bottom = self.bars[0]
        beside = [(y - 4.3, float(t)) for x, y, t, _ in self.texts
                  if x is not None and 0 < x - right < 30 and top < y < bottom + 10 and re.fullmatch(r" *-?[\d.e-]+", t)]
        line = np.polyfit(*zip(*beside), 1)
        return np.polyval(line, bottom), np.polyval(line, top)

    def legend(self):
        """Text -> colour: of each filled box of the page the text right of it."""
        entries = {}
        for fill, points in self.page.areas:
            xs, ys = [p[0] for p in points], [p[1] for p in points]
            if len(points) == 4 and abs(max(ys) - min(ys) - 14) < 0.1:
                near = [t for x, y, t, _ in self.texts if x is not None and abs(x - max(xs) - 8) < 1 and
                        abs(y - 4.3 - (min(ys) + max(ys)) / 2) < 3]
                entries[near[0] if near else None] = fill
        return entries
