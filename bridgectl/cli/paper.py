"""`bridgectl paper`: the paper's numbers beside the computed ones."""

from __future__ import annotations

import argparse
import json
from typing import Any

from bridgectl._tables import make_console, make_table
from bridgectl._version import __version__
from bridgectl.cli import options
from bridgectl.paper.printed import PaperResults, paper_results


def run_paper(args: argparse.Namespace) -> None:
    """Do what the command asks for."""
    options.check_plot(args.plot)
    with options.working("computing the paper's surfaces"):
        results = paper_results()
    options.deliver(
        args, lambda: options.figure("surface.paper", results),
        lambda: json.dumps(paper_json(results), indent=1), lambda: print_paper(results),
    )  # fmt: skip


def paper_json(results: PaperResults) -> dict[str, Any]:
    """Give the paper's numbers and the computed ones."""
    return {
        "bridgectl": __version__,
        "results": [{**row._asdict(), "difference": row.difference} for row in results.rows],
        "smooth_road": [{"speed_km_per_h": kmh, "daf": value} for kmh, value in results.smooth_daf],
    }


def print_paper(results: PaperResults) -> None:
    """Print the paper's numbers beside the computed ones, and Fig. 2."""
    console = make_console()
    title = "Li, OBrien and Gonzalez (2006), printed and computed"
    columns = ["what", "printed", "computed", "difference", "note"]
    table = make_table(title, columns, ["what", "note"])
    for row in results.rows:
        digits = {"km/h": 0, "x/l": 3}.get(row.unit, 5)
        unit = f" {row.unit}" if row.unit else ""
        printed = "-" if row.printed is None else f"{row.printed:g}{unit}"
        difference = "-" if row.difference is None else f"{row.difference:+.{digits}f}"
        table.add_row(row.what, printed, f"{row.computed:.{digits}f}{unit}", difference, row.note)
    console.print(table)
    table = make_table("Fig. 2: DAF of a smooth road, computed", ["speed [km/h]", "DAF"])
    for kmh, value in results.smooth_daf:
        table.add_row(f"{kmh:g}", f"{value:.5f}")
    console.print(table)
