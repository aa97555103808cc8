"""The figures as text for people."""

from comparison.programs import PROGRAMS, STAGES

MIB = 2**20


def seconds(value):
    """Three digits that count, in seconds."""
    if value is None:
        return "-"
    if value >= 100:
        return f"{value:.0f}"
    return f"{value:.2f}" if value >= 10 else f"{value:.3f}" if value >= 1 else f"{value:.4f}"


def quartiles(found):
    return f"{seconds(found['lower'])} .. {seconds(found['upper'])}"


def table(head, rows):
    """Columns as wide as they need; the first to the left, the others to the right."""
    lines = [head, *rows]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    return "\n".join(
        "  ".join(
            cell.ljust(width) if i == 0 else cell.rjust(width)
            for i, (cell, width) in enumerate(zip(line, widths, strict=True))
        ).rstrip()
        for line in lines
    )


def smoothers(size):
    """Filter and smoother alone, of one size."""
    measured = size["programs"]
    ours = measured.get("library", {}).get("seconds", {}).get("median")
    rows = []
    for program in PROGRAMS:
        if program.kind != "smoother" or program.key not in measured:
            continue
        found = measured[program.key]
        median = found["seconds"]["median"]
        same = found.get("agreement", {})
        differences = [value for value in same.values() if value is not None]
        rows.append(
            [
                program.title,
                seconds(median),
                quartiles(found["seconds"]),
                f"{median / ours:.2f}" if ours else "-",
                seconds(found.get("filter_seconds", {}).get("median")),
                seconds(found["process_seconds"]["median"]),
                f"{found['peak_bytes']['median'] / MIB:.0f}",
                f"{max(differences):.0e}" if differences else "-",
            ]
        )
    if not rows:
        return ""
    head = ["filter and smoother", "s", "quartiles", "times ours", "filter alone, s"]
    head += ["whole process, s", "MiB", "differs by"]
    return (
        f"{size['epochs']:,} epochs, {repeats_text(size['repeats'])}\n\n{table(head, rows)}\n"
        f"{left_out(size)}"
    )


def repeats_text(repeats):
    return "once" if repeats == 1 else f"medians of {repeats} in turns"


def left_out(size):
    titles = {program.key: program.title for program in PROGRAMS}
    lines = [f"  not run: {titles[key]}, {why}\n" for key, why in size["left_out"].items()]
    lines += [f"  failed: {titles[key]}: {why}\n" for key, why in size["failed"].items()]
    return "".join(lines)


def runs(sizes, exponents):
    """certify, by stage and size."""
    sizes = [size for size in sizes if "certify" in size["programs"]]
    if not sizes:
        return ""
    found = [size["programs"]["certify"] for size in sizes]

    def row(title, figure, show=seconds, exponent=None):
        slope = exponents.get(exponent, {}).get("all")
        cells = [show(one[figure]["median"]) for one in found]
        return [title, *cells, "-" if slope is None else f"{slope:.3f}"]

    rows = [row(stage, f"stage {stage}", exponent=f"stage {stage}") for stage in STAGES]
    rows.append(row("to the verdict, s", "seconds", exponent="certify"))
    rows.append(["  quartiles", *[quartiles(one["seconds"]) for one in found], ""])
    rows.append(row("with the report, s", "process_seconds"))
    rows.append(row("processor time, s", "processor_seconds"))
    rows.append(row("memory, MiB", "peak_bytes", show=lambda value: f"{value / MIB:.0f}"))
    head = ["runcert certify --no-render", *[f"{size['epochs']:,}" for size in sizes], "exponent"]
    return f"{table(head, rows)}\n{pairs_text(exponents)}"


def pairs_text(exponents):
    """Exponents between neighbouring sizes, where there are more than two."""
    lines = []
    for name in [*[f"stage {stage}" for stage in STAGES], "certify"]:
        pairs = exponents.get(name, {}).get("pairs", [])
        if len(pairs) > 1:
            shown = ", ".join(
                f"{pair['exponent']:.3f} to {pair['to']:,}" for pair in pairs
            )
            lines.append(f"  {name.removeprefix('stage ')}, from size to size: {shown}")
    return "\n".join(lines) + "\n" if lines else ""


def reading(sizes):
    """Tables, and NMEA beside gpsbabel."""
    rows = []
    for size in sizes:
        measured = size["programs"]
        if "tables" in measured:
            found = measured["tables"]
            for title, figure, count in (
                ("reading .pos into rows", "read_pos", "pos"),
                ("writing ECSV", "write_ecsv", "ecsv"),
                ("reading ECSV into rows", "read_ecsv", "ecsv"),
            ):
                taken = found[f"{figure}_seconds"]
                speed = found[f"{count}_bytes"]["median"] / taken["median"] / 1e6
                cells = [seconds(taken["median"]), quartiles(taken), f"{speed:.0f}", ""]
                rows.append([title, f"{size['epochs']:,}", *cells])
        for key in ("nmea", "gpsbabel"):
            if key in measured:
                title = measured[key]["title"]
                taken, peak = measured[key]["seconds"], measured[key]["peak_bytes"]["median"]
                cells = [seconds(taken["median"]), quartiles(taken), "", f"{peak / MIB:.0f}"]
                rows.append([title, f"{size['epochs']:,}", *cells])
    if not rows:
        return ""
    return table(["reading and writing", "epochs", "s", "quartiles", "MB/s", "MiB"], rows) + "\n"


def solving(found):
    """What it takes to get positions from what a receiver observed, for reference."""
    if not found:
        return ""
    return (
        f"For reference: rnx2rtkp solves {found['epochs']} epochs of RINEX in "
        f"{seconds(found['seconds']['median'])} s ({quartiles(found['seconds'])}), "
        f"{found['seconds']['median'] / found['epochs'] * 1e3:.2f} ms an epoch.\n"
    )


def figure(value):
    return "-" if value is None else f"{value:.3g}" if value < 1000 else f"{value:.0f}"


def asked(requirements):
    words = {True: "met", False: "NOT MET", None: "not measured"}
    rows = [[one.what, figure(one.found), one.asked(), words[one.is_met()]] for one in requirements]
    return table(["It must show", "found", "asked", ""], rows) + "\n"


def machine(found):
    return (
        f"{found['system']}, {found['processor']}, {found['cores']} cores, "
        f"{found['memory_gib']:.0f} GiB of memory; load average {found['load_before']:.1f} to "
        f"{found['load_after']:.1f}; seed {found['seed']}\n"
    )


def whole(result, requirements):
    """All tables."""
    sizes, slopes = result["sizes"], result["exponents"]
    parts = [machine(result["machine"]), *[smoothers(size) for size in sizes]]
    parts += [runs(sizes, slopes), reading(sizes), solving(result["solving"])]
    parts += ["".join(f"{one}\n" for one in result["missing"]), asked(requirements)]
    return "\n".join(part for part in parts if part)
