# SPDX-License-Identifier: Apache-2.0
"""One look for all plots: the letters and colours of the program's own pictures (src/render). Needs matplotlib (Debian:
python3-matplotlib)."""

from pathlib import Path

FONT = Path(__file__).resolve().parent.parent / "src/render/font/inter.ttf"
INK, FAINT, GRID = "#282c34", "#6b7280", "#dfe2e8"
RED, BLUE = "#b3202a", "#2f6fc4"
# Of series beside each other: standoff's red first, then colours that those who see no red tell apart by their lightness.
SERIES = [RED, BLUE, "#e08b2d", "#3d8f6f", "#8a6fb3", "#6b7280"]
REST = "#a9b2c0"  # of what is not standoff's


def pyplot():
    """matplotlib.pyplot in this look, or None without matplotlib. The same numbers make the same bytes."""
    try:
        import matplotlib
    except ImportError:
        return None
    matplotlib.use("Agg")
    from matplotlib import cycler, font_manager

    font_manager.fontManager.addfont(str(FONT))
    name = font_manager.FontProperties(fname=str(FONT)).get_name()
    matplotlib.rcParams |= {
        "svg.fonttype": "path", "svg.hashsalt": "standoff",
        "font.family": name, "font.size": 10, "axes.titlesize": 11, "axes.titlelocation": "left", "axes.titlepad": 10,
        "mathtext.fontset": "custom", "mathtext.rm": name, "mathtext.it": name, "mathtext.bf": name, "mathtext.cal": name, "mathtext.sf": name, "mathtext.tt": name,
        "text.color": INK, "axes.labelcolor": INK, "axes.titlecolor": INK, "xtick.color": FAINT, "ytick.color": FAINT,
        "axes.edgecolor": FAINT, "axes.linewidth": 0.8, "axes.spines.top": False, "axes.spines.right": False,
        "axes.axisbelow": True, "grid.color": GRID, "grid.linewidth": 0.8, "legend.frameon": False, "legend.fontsize": 9,
        "axes.prop_cycle": cycler(color=SERIES), "lines.linewidth": 1.8, "lines.markersize": 5,
        "figure.dpi": 100, "savefig.dpi": 100, "savefig.facecolor": "white",
    }  # fmt: skip
    from matplotlib import pyplot

    return pyplot


def save(figure, path):
    """As PNG or SVG, without a date or a version in it."""
    suffix = Path(path).suffix
    figure.savefig(path, metadata={"Date": None, "Creator": None} if suffix == ".svg" else {"Software": None})
    if suffix == ".png":
        from PIL import Image

        few = Image.open(path).convert("RGB").quantize(64, dither=Image.Dither.NONE)
        few.save(path, optimize=True)
    print(f"wrote {path}")
