#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/images/python_fields.svg out of python.csv: how many samples a second each library finds. Needs matplotlib.

  bench/python_plot.py [RESULTS]"""

import sys
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt

from harness import BENCH
from output_quotes import AVX512, RESULTS
from quotes import read

matplotlib.use("Agg")
matplotlib.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "standoff"}
COLOURS = {"standoff": "#b3202a"}


def draw(rows, path):
    """A panel for each field; bars of millions of samples a second, in a logarithmic scale."""
    groups = {}
    for row in rows:
        groups.setdefault((row["field"], row["sign"]), []).append(row)
    figure, panels = plt.subplots(len(groups), 1, figsize=(7, 0.34 * len(rows) + 0.6 * len(groups)), sharex=True,
                                  gridspec_kw={"height_ratios": [len(own) + 1 for own in groups.values()]})
    for panel, ((field, sign), own) in zip(panels, groups.items()):
        own = sorted(own, key=lambda row: -float(row["s"]))
        rates = [float(row["samples"]) / float(row["s"]) / 1e6 for row in own]
        panel.barh([row["library"] for row in own], rates, color=[COLOURS.get(row["library"], "#9aa7b8") for row in own])
        for place, rate in enumerate(rates):
            panel.text(rate * 1.08, place, f"{rate:.3g}", va="center", fontsize=8)
        panel.set_title(f"{field}{', signed' if sign == 'yes' else ''}", loc="left", fontsize=9)
        panel.set_xscale("log")
        panel.tick_params(labelsize=8)
        panel.spines[["top", "right"]].set_visible(False)
    panels[-1].set_xlabel("million samples a second")
    rates = [float(row["samples"]) / float(row["s"]) / 1e6 for row in rows]
    panels[0].set_xlim(min(rates) / 2, max(rates) * 3)
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})


if __name__ == "__main__":
    results = Path(sys.argv[1]) if len(sys.argv) > 1 else RESULTS / AVX512
    draw(read(results / "python.csv")[1], BENCH.parent / "docs" / "images" / "python_fields.svg")
