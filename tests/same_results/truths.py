"""What else than the certified positions says of a certified window: true positions, another
receiver, the recorded velocities, what a device printed. Speeds in m/s, times in seconds.

A reference has its own samples; between them it is interpolated by its velocities, and it says
nothing where two samples are further apart than half a second."""

import bisect
import csv
import math
import re
from datetime import datetime, timedelta, timezone
from pathlib import Path

import yaml

GPS_EPOCH = datetime(1980, 1, 6)
# Figures of the folder's README, from the raw file: vertical, the best 3 s.
SKYDIVES = {"jump-1_good": (("heights at both ends", 444.61 / 3.6), ("mean of velD", 443.47 / 3.6))}


def gps_seconds(text):
    """Of "2023-07-11T06:06:29.200", in GPS time, since the beginning of it."""
    whole, _, part = text.partition(".")
    seconds = (datetime.fromisoformat(whole) - GPS_EPOCH).total_seconds()
    return seconds + (float("0." + part.rstrip("Z")) if part else 0.0)


class Track:
    """Positions and velocities at times, each a list of 2 or 3 numbers in a fixed frame."""

    def __init__(self, rows, longest_step_s=0.5):
        self.rows = sorted(rows, key=lambda row: row[0])
        self.times = [row[0] for row in self.rows]
        self.longest_step_s = longest_step_s

    def at(self, time_s):
        """The position, by cubic interpolation; None where there is no sample near."""
        after = bisect.bisect_left(self.times, time_s - 1e-6)
        if after == len(self.times):
            return None
        if abs(self.times[after] - time_s) <= 1e-6:
            return self.rows[after][1]
        if after == 0:
            return None
        (t0, p0, v0), (t1, p1, v1) = self.rows[after - 1], self.rows[after]
        step = t1 - t0
        if step > self.longest_step_s:
            return None
        s = (time_s - t0) / step
        return [(1 + 2 * s) * (1 - s) ** 2 * a + s * (1 - s) ** 2 * step * u
                + s * s * (3 - 2 * s) * b + s * s * (s - 1) * step * w
                for a, b, u, w in zip(p0, p1, v0, v1)]

    def displacement(self, start_s, end_s):
        first, last = self.at(start_s), self.at(end_s)
        return None if first is None or last is None else [b - a for a, b in zip(first, last)]


def up_at(ecef):
    """Unit vector upwards at a point of the Earth (WGS 84), within 1e-5."""
    x, y, z = ecef
    latitude = math.atan2(z, (1 - 0.00669437999014) * math.hypot(x, y))
    longitude = math.atan2(y, x)
    return [math.cos(latitude) * math.cos(longitude), math.cos(latitude) * math.sin(longitude),
            math.sin(latitude)]


def horizontal_speed(track, start_s, end_s):
    """Of a track in ECEF coordinates: displacement along the ground over time."""
    moved = track.displacement(start_s, end_s)
    if moved is None:
        return None
    up = up_at(track.at(0.5 * (start_s + end_s)) or track.at(start_s))
    rise = sum(a * b for a, b in zip(moved, up))
    return math.sqrt(max(0.0, sum(a * a for a in moved) - rise * rise)) / (end_s - start_s)


def plane_speed(track, start_s, end_s):
    moved = track.displacement(start_s, end_s)
    return None if moved is None else math.hypot(moved[0], moved[1]) / (end_s - start_s)


def rows_of(file):
    with open(file, encoding="utf-8", newline="") as stream:
        yield from csv.DictReader((line for line in stream if not line.startswith("#")),
                                  skipinitialspace=True)


def urban_car(folder):
    """Times in GPS seconds. The point is 8 cm east of the antenna all along: no displacement."""
    rows = []
    for row in rows_of(folder / "ppk_urban_car" / "reference.csv"):
        time_s = int(row["GPS Week"]) * 604800 + float(row["GPS TOW (s)"])
        position = [float(row[f"ECEF {axis} (m)"]) for axis in "XYZ"]
        up = up_at(position)
        across = math.hypot(up[0], up[1])
        east = [-up[1] / across, up[0] / across, 0.0]
        north = [up[1] * east[2] - up[2] * east[1], up[2] * east[0] - up[0] * east[2],
                 up[0] * east[1] - up[1] * east[0]]
        speeds = [float(row[f"{axis} Velocity (m/s)"]) for axis in ("East", "North", "Up")]
        velocity = [sum(speed * axis[i] for speed, axis in zip(speeds, (east, north, up)))
                    for i in range(3)]
        rows.append((time_s, position, velocity))
    return Track(rows)


def freeway(folder):
    """Times in GPS seconds: the host's clock is that of the first pose."""
    rows = []
    for row in rows_of(folder / "freeway_pose" / "pose.csv"):
        time_s = 2012 * 604800 + 404106.397 + float(row["host_time_s"]) - 46408.547498
        rows.append((time_s, [float(row[f"{axis}_ecef_m"]) for axis in "xyz"],
                     [float(row[column]) for column in row if column.startswith("v")]))
    return Track(rows)


def simulated(file):
    """Times from the beginning. The speed's direction is that of the way to the next sample."""
    table = [(float(row["time_s"]), [float(row["east_m"]), float(row["north_m"])],
              float(row["speed_m_s"] if "speed_m_s" in row else row["velocity_m_s"]))
             for row in rows_of(file)]
    rows = []
    for k, (time_s, position, speed) in enumerate(table):
        (_, a, _), (_, b, _) = table[max(0, k - 1)], table[min(len(table) - 1, k + 1)]
        length = math.hypot(b[0] - a[0], b[1] - a[1]) or 1.0
        rows.append((time_s, position, [speed * (q - p) / length for p, q in zip(a, b)]))
    # The table of the land yacht leaves out what is nearly a straight line.
    return Track(rows, longest_step_s=15.0)


class Velocities:
    """What a receiver recorded of velocity, and how many of its epochs are usable, from the
    screened table of a run; the delay behind the positions is the one that was estimated there."""

    AXES = ("east", "north", "up")

    def __init__(self, run):
        text = (run / "3-screened.ecsv").read_text(encoding="utf-8")
        head = "".join(line[2:] for line in text.splitlines(keepends=True)
                       if line.startswith("# "))
        origin = re.search(r"^ *first_epoch_gps: \"([^\"]+)\"", head, re.MULTILINE)
        delay = re.search(r"^ *velocity:\n(?: .*\n){0,9}? *delay_s: ([-0-9.e]+)", head,
                          re.MULTILINE)
        self.first_s = gps_seconds(origin.group(1)) if origin else None
        self.delay_s = float(delay.group(1)) if delay else 0.0
        self.rows = []
        self.usable, self.epochs = 0, 0
        for row in csv.DictReader(line for line in text.splitlines() if not line.startswith("#")):
            self.epochs += 1
            self.usable += row["usable"] == "True"
            values = [row.get(f"recorded_velocity_{axis}") for axis in self.AXES]
            if values[0] and values[1]:
                self.rows.append((float(row["time"]), [float(value or "nan") for value in values]))
        self.times = [row[0] for row in self.rows]

    def at(self, time_s):
        after = bisect.bisect_left(self.times, time_s - 1e-6)
        if after == len(self.rows):
            return None
        if abs(self.times[after] - time_s) <= 1e-6:
            return self.rows[after][1]
        if after == 0 or self.times[after] - self.times[after - 1] > 1.5:
            return None
        share = (time_s - self.times[after - 1]) / (self.times[after] - self.times[after - 1])
        return [(1 - share) * a + share * b
                for a, b in zip(self.rows[after - 1][1], self.rows[after][1])]

    def window(self, start_s, end_s):
        """Velocities at the window's ends and between them, as they were at these times."""
        start_s, end_s = start_s + self.delay_s, end_s + self.delay_s
        inside = [(time, value) for time, value in self.rows
                  if start_s + 1e-6 < time < end_s - 1e-6]
        ends = self.at(start_s), self.at(end_s)
        if ends[0] is None or ends[1] is None:
            return None
        series = [(start_s, ends[0]), *inside, (end_s, ends[1])]
        if max(b[0] - a[0] for a, b in zip(series, series[1:])) > 1.5:
            return None
        return series

    def speed(self, start_s, end_s, definition, dimension):
        """By the definition of the rule, over the window; None where not all of it is there."""
        series = self.window(start_s, end_s)
        if series is None:
            return None
        axes = (2,) if dimension == "vertical" else (0, 1)
        length_s = end_s - start_s
        if definition in ("mean_n", "mean_n_plus_1"):
            samples = series[1:] if definition == "mean_n" else series
            return sum(math.hypot(*(value[i] for i in axes)) for _, value in samples) / len(samples)
        if definition == "path_length":
            speeds = [(time, math.hypot(*(value[i] for i in axes))) for time, value in series]
            return sum(0.5 * (b[0] - a[0]) * (a[1] + b[1])
                       for a, b in zip(speeds, speeds[1:])) / length_s
        moved = [sum(0.5 * (b[0] - a[0]) * (a[1][i] + b[1][i]) for a, b in zip(series, series[1:]))
                 for i in axes]
        return math.hypot(*moved) / length_s


# What devices print beside a speed, by the rule that it is the figure of.
DEVICE_FIGURES = {"gps-speed-sailing-2s": "S2", "gps-speed-sailing-10s": "S10",
                  "gps-speed-sailing-500m": "M500", "gps-speed-sailing-nautical-mile": "M1852",
                  "gps-speed-sailing-1h": "S3600"}


def device_result(file, profile, start_utc, duration_s):
    """What the device printed for that window: it stamps the end, in local time, UTC+2."""
    code = DEVICE_FIGURES.get(profile)
    if code is None or not file.is_file():
        return None
    start = datetime.fromisoformat(start_utc.replace("Z", "+00:00").split(".")[0].split("+")[0]
                                   ).replace(tzinfo=timezone.utc)
    for line in file.read_text(encoding="utf-8", errors="replace").splitlines():
        found = re.match(rf" *([0-9.]+) km/h (\d+):(\d+):(\d+) .*\b{code}$", line.strip())
        if not found:
            continue
        hour, minute, second = (int(found.group(i)) for i in (2, 3, 4))
        stamp = start.replace(hour=hour, minute=minute, second=second) - timedelta(hours=2)
        if -2.0 <= (stamp - start).total_seconds() <= duration_s + 3.0:
            return float(found.group(1)) / 3.6
    return None


def read_yaml(file):
    return yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.CSafeLoader)


class Truths:
    """The truths of one folder that `record` made."""

    def __init__(self, out):
        self.out = out
        self.data = out / "work" / "recordings"
        self.tracks = {}
        self.heard = {}

    def velocities(self, run):
        if run not in self.heard:
            self.heard[run] = Velocities(run)
        return self.heard[run]

    def track(self, name):
        if name not in self.tracks:
            examples = self.out / "work" / "examples"
            if name == "urban-car":
                made = urban_car(self.data)
            elif name == "freeway":
                made = freeway(self.data)
            elif name == "land_yacht":
                made = simulated(examples / name / "table_2_reference.csv")
            else:
                truth = examples / name / "truth.csv"
                made = simulated(truth) if truth.is_file() else None
            self.tracks[name] = made
        return self.tracks[name]

    def of(self, run, profile, rule, window):
        """(who says so, speed in m/s) for each that says something of the very window."""
        if rule.get("count", 1) != 1 or rule["kind"] not in ("time", "distance"):
            return
        name = run.name
        start_s, length_s = float(window["start_time_s"]), float(window["duration_s"])
        start_gps = gps_seconds(window["start_gps"]) if "start_gps" in window else None
        by_displacement = rule["definition"] == "displacement" and rule["dimension"] == "horizontal"
        if name in ("urban-car", "freeway") and by_displacement:
            yield "reference", horizontal_speed(self.track(name), start_gps, start_gps + length_s)
        elif run.parent.name == "runs" and by_displacement and self.track(name):
            yield "truth", plane_speed(self.track(name), start_s, start_s + length_s)
        if rule["source"] == "position":
            yield "own velocities", self.velocities(run).speed(
                start_s, start_s + length_s, rule["definition"], rule["dimension"])
        for label, speed in SKYDIVES.get(name, ()):
            yield label, speed
        if name.startswith("surf-"):
            yield from self.of_board(run, profile, rule, window, start_gps, length_s)

    def of_board(self, run, profile, rule, window, start_gps, length_s):
        for other in sorted(run.parent.glob("surf-*")):
            if other == run or not (other / "3-screened.ecsv").is_file():
                continue
            heard = self.velocities(other)
            start_s = start_gps - heard.first_s
            yield other.name.removeprefix("surf-"), heard.speed(
                start_s, start_s + length_s, rule["definition"], rule["dimension"])
        file = self.data / "windsurf_loggers" / (
            run.name.removeprefix("surf-") + "_device_results.txt")
        yield "device", device_result(file, profile, window["start_utc"], length_s)
