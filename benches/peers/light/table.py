"""The tables that the benchmark prints, in Markdown."""

from measure import OURS

CLOCKS = {"wall": "seconds", "cpu": "CPU seconds"}


def rows(head, lines):
    """A Markdown table with its columns aligned."""
    cells = [head, *lines]
    widths = [max(len(line[i]) for line in cells) for i in range(len(head))]
    padded = ["| " + " | ".join(cell.ljust(width) for cell, width in zip(line, widths)) + " |" for line in cells]
    return [padded[0], "| " + " | ".join("-" * width for width in widths) + " |", *padded[1:]]


def short(value):
    """Three significant digits, without an exponent where it is not needed."""
    return f"{value:.3g}" if 1e-4 <= value < 1000 else f"{value:.2e}"


def details(results, clocks):
    """Every program on every scene."""
    head = ["scene", "program", "rel. variance", *(CLOCKS[clock] for clock in clocks)]
    head += [f"variance × {CLOCKS[clock]}" for clock in clocks] + ["mean", "compiled in, s"]
    lines = []
    for result in results:
        for name, line in result["programs"].items():
            lines.append(
                [
                    result["scene"],
                    name,
                    f"{short(line['variance'])} ± {100 * line['error']:.0f} %",
                    *(f"{line[clock]:.3f}" for clock in clocks),
                    *(short(line[f"variance_x_{clock}"]) for clock in clocks),
                    f"{line['mean']:.5f}",
                    f"{line['compile']:.2f}" if line.get("compile") else "-",
                ]
            )
    return rows(head, lines)


def disagreements(results):
    """For each scene without a ratio, whose means differ, and by how much."""
    return [
        f"{result['scene']} has no ratio: the mean of {name} is {100 * line['share']:+.2f} % off spherule's "
        f"({line['image_score']:+.1f} standard errors; tiles {line['tile_score']:.2f}, at most {line['most_tile_score']:.2f})"
        for result in results
        for name, line in result["agreement"].items()
        if not line["agrees"]
    ]


def ratio_row(result, clocks):
    if "ratios" not in result:
        return [result["scene"], *["-"] * (5 + len(clocks))]
    clock = clocks[-1]
    best = result["ratios"][clock]["best"]
    ours, theirs = result["programs"][OURS], result["programs"][best]
    ratio = [result["ratios"][clock] for clock in reversed(clocks)]
    return [
        result["scene"],
        best,
        short(ours["variance"]),
        short(theirs["variance"]),
        f"{ours[clock]:.2f}",
        f"{theirs[clock]:.2f}",
        *(f"{line['ratio']:.2f} ± {line['error']:.2f}" for line in ratio),
    ]


def summary(results, clocks):
    """spherule against the Mitsuba that is best on the scene."""
    unit = CLOCKS[clocks[-1]]
    head = ["scene", "best Mitsuba", "variance: spherule", "Mitsuba", f"{unit}: spherule", "Mitsuba"]
    head += [f"ratio by {CLOCKS[clock]}" for clock in reversed(clocks)]
    return rows(head, [ratio_row(result, clocks) for result in results])
