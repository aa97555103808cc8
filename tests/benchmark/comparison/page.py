"""What is written: files, the picture of time against epochs, and the page."""

import os
import subprocess
import tempfile
from pathlib import Path

from comparison.measure import Trouble
from comparison.programs import PROGRAMS

BEGIN, END = "<!-- comparison: begin -->", "<!-- comparison: end -->"
PICTURE = "comparison.svg"  # beside the page
# Ours in blues; Okabe & Ito's colours, which colour-blind readers tell apart, for the others.
COLOURS = {
    "library": "#0040c0", "certify": "#002060", "nmea": "#0040c0",
    "eigen": "#000000", "ceres": "#009e73", "statsmodels": "#d55e00", "statsmodels-all": "#f0a060",
    "numpy": "#e69f00", "octave": "#cc79a7", "gpsbabel": "#808080",
}


def write_atomically(file, text):
    """Under a temporary name in the same folder, then renamed."""
    name = None
    try:
        with tempfile.NamedTemporaryFile(
            "w", encoding="utf-8", dir=Path(file).absolute().parent, delete=False
        ) as stream:
            name = stream.name
            stream.write(text)
        os.chmod(name, 0o644)
        os.replace(name, file)
    except OSError as error:
        if name:
            Path(name).unlink(missing_ok=True)
        raise Trouble(
            f"{file}: cannot be written: {error.strerror}. Name a file in a folder that can be"
        ) from error


def series(sizes):
    """Each program that has times, and its points (epochs, times)."""
    for program in PROGRAMS:
        points = [
            (size["epochs"], size["programs"][program.key]["seconds"])
            for size in sizes
            if "seconds" in size["programs"].get(program.key, {})
        ]
        if points:
            yield program, sorted(points, key=lambda point: point[0])


def script_of(sizes):
    """The picture as gnuplot draws it: medians, with bars from quartile to quartile."""
    dash = {"smoother": 1, "run": 1, "reading": 2}
    lines = [
        "set terminal svg size 900,620 dynamic noenhanced font 'DejaVu Sans,13' background 'white'",
        "set logscale xy",
        "set format x '%.0f'",
        "set format y '%g'",
        "set xlabel 'epochs'",
        "set ylabel 'seconds'",
        "set key outside right top reverse Left",
        "set grid",
    ]
    plots = []
    for number, (program, points) in enumerate(series(sizes), start=1):
        lines.append(f"$data{number} << EOD")
        for epochs, found in points:
            lines.append(f"{epochs} {found['median']} {found['lower']} {found['upper']}")
        lines.append("EOD")
        width = 4 if program.kind == "run" else 2
        style = f"lw {width} lc rgb '{COLOURS[program.key]}' dt {dash[program.kind]} pt 7 ps 0.5"
        plots.append(
            f"$data{number} using 1:2:3:4 with yerrorlines {style} title '{program.title}'"
        )
    lines.append("plot " + ", \\\n  ".join(plots))
    return "\n".join(lines) + "\n"


def picture(sizes):
    """The SVG, by gnuplot; None where nothing has times."""
    if not list(series(sizes)):
        return None
    drawn = subprocess.run(
        ["gnuplot"], input=script_of(sizes), capture_output=True, text=True, check=False
    )
    if drawn.returncode != 0 or not drawn.stdout.rstrip().endswith("</svg>"):
        raise Trouble(f"gnuplot: {drawn.stderr.strip()}. Run it by hand to see what it says")
    return drawn.stdout


def require_marks(page):
    """The page's text. Trouble where it has not the two lines between which the tables belong."""
    try:
        text = Path(page).read_text(encoding="utf-8")
    except OSError as error:
        raise Trouble(
            f"{page}: cannot be read: {error.strerror}. Name a page that has the lines "
            f"{BEGIN} and {END}"
        ) from error
    if text.count(BEGIN) != 1 or text.count(END) != 1 or text.index(BEGIN) > text.index(END):
        raise Trouble(
            f"{page}: the lines {BEGIN} and {END} are not in it once, in this order. "
            "Put them where the tables belong"
        )
    return text


def replace_tables(page, text, drawn):
    """Puts tables and picture between the two marks."""
    head, rest = require_marks(page).split(BEGIN)
    tail = rest.split(END)[1]
    image = f"![Time against epochs]({PICTURE})\n\n" if drawn is not None else ""
    if drawn is not None:
        write_atomically(Path(page).parent / PICTURE, drawn)
    write_atomically(page, f"{head}{BEGIN}\n{image}```\n{text}```\n{END}{tail}")
