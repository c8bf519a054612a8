# SPDX-License-Identifier: Apache-2.0
"""pages.py FOLDER [--pictures FOLDER]: opens every page of the site in a browser, as wide as a phone and as a screen.

No page is wider than the window, complains, or asks for anything that is not its own; every picture is there; the search
finds words; text can be read on dark and on light ground. With --pictures each page is also drawn, for people to look at."""

import argparse
import asyncio
import base64
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "support"))
from browser import browser, served  # noqa: E402

WIDTHS = {"phone": (390, 844), "screen": (1280, 900)}

# What is wrong with a page's layout, as sentences. A part that scrolls by itself may hold what is wider.
# A phone's window grows with what is in it, and the theme hides what its column of text does not hold, so that
# documentElement.scrollWidth alone tells nothing.
LAYOUT = """((wide) => {
  const found = [], root = document.documentElement, column = document.querySelector('.content');
  const widest = Math.max(root.scrollWidth, innerWidth, column ? column.getBoundingClientRect().left + column.scrollWidth : 0);
  if (widest > wide + 1) {
    const scrolls = e => { for (let p = e; p && p !== column && p !== document.body; p = p.parentElement)
      if (['auto', 'scroll', 'hidden'].includes(getComputedStyle(p).overflowX) || getComputedStyle(p).position === 'fixed') return true;
      return false; };
    const parts = [...document.body.querySelectorAll('*')].filter(e => e.getBoundingClientRect().right > wide + 1 && !scrolls(e));
    found.push(`is ${widest} wide in a window of ${wide}: `
      + parts.slice(-3).map(e => `<${e.tagName.toLowerCase()} class="${e.className}"> ${e.textContent.slice(0, 60)}`).join('; '));
  }
  for (const image of document.images)
    if (image.naturalWidth === 0 && image.loading !== 'lazy') found.push(`the picture ${image.src} is not there`);
  return found;
})(%d)"""

# The least contrast of text and what is behind it, of each kind of text (WCAG asks for 4.5).
CONTRAST = """(() => {
  const canvas = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
  const bytes = c => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = c; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
  const light = c => { const [r, g, b] = c.map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const behind = e => { for (; e; e = e.parentElement) { const c = bytes(getComputedStyle(e).backgroundColor); if (c[3] > 250) return c.slice(0, 3); }
    return [255, 255, 255]; };
  const least = {};
  for (const e of document.querySelectorAll('.content p, .content a, .content pre span, .content code, .content .sig, .content .sig span, .sidebar-tree a')) {
    if (!e.textContent.trim() || e.classList.contains('headerlink') || e.closest('.headerlink')) continue;
    const a = light(bytes(getComputedStyle(e).color).slice(0, 3)), b = light(behind(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    const kind = e.tagName.toLowerCase() + '.' + e.className;
    if (!(least[kind] <= ratio)) least[kind] = ratio;
  }
  return least;
})()"""
SETTLED = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


async def look_at(tab, path, wrong, pictures):
    tab.complaints.clear()
    for kind, (width, height) in WIDTHS.items():
        await tab.size(width, height, phone=kind == "phone")
        if kind == "phone":
            await tab.open(path)
        await tab.ask(SETTLED)
        wrong += [f"{path}, on a {kind}: {fault}" for fault in await tab.ask(LAYOUT % width)]
        if pictures:
            shot = await tab.call("Page.captureScreenshot", format="png", captureBeyondViewport=False)
            (pictures / f"{path.removesuffix('.html').replace('/', '_')}-{kind}.png").write_bytes(
                base64.b64decode(shot["data"])
            )
    wrong += [f"{path}: {complaint}" for complaint in tab.complaints]


async def look_at_colours(tab, paths, wrong, pictures):
    for scheme in ("light", "dark"):
        await tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        for path in paths:
            await tab.open(path)
            await tab.ask(SETTLED)
            ground = await tab.ask("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
            if (sum(ground[:3]) < 3 * 128) != (scheme == "dark"):
                wrong.append(f"{path}: its ground is {ground} in a {scheme} browser")
            for kind, ratio in (await tab.ask(CONTRAST)).items():
                if ratio < 4.5:
                    wrong.append(f"{path}, {scheme}: text in {kind} has a contrast of only {ratio:.2f}")
            if pictures and scheme == "dark":
                shot = await tab.call("Page.captureScreenshot", format="png")
                (pictures / f"{path.removesuffix('.html').replace('/', '_')}-dark.png").write_bytes(
                    base64.b64decode(shot["data"])
                )


async def search(tab, words, expected, wrong, first=None):
    """The search finds the page, among the `first` so many."""
    await tab.open(f"search.html?q={words}")
    for _ in range(100):
        found = await tab.ask("[...document.querySelectorAll('ul.search a')].map(a => a.getAttribute('href'))")
        if any(expected in one for one in found[:first]):
            return
        await asyncio.sleep(0.1)
    wrong.append(f"the search for {words} finds {found[:8]}, not {expected}")


async def main(folder, pictures):
    paths = sorted(str(path.relative_to(folder)) for path in folder.rglob("*.html") if "_static" not in path.parts)
    wrong: list[str] = []
    with served(folder) as home:
        async with browser(home) as tab:
            # A page that is too wide must be noticed, or nothing here is worth anything.
            await tab.size(*WIDTHS["phone"], phone=True)
            await tab.open(paths[0])
            await tab.ask(
                "document.querySelector('article').appendChild(document.createElement('div')).style = 'width: 900px; height: 9px'"
            )
            if not await tab.ask(LAYOUT % WIDTHS["phone"][0]):
                sys.exit("a part that is 900 wide is not noticed on a phone; the check is broken")
            for path in paths:
                await look_at(tab, path, wrong, pictures)
            await look_at_colours(
                tab,
                ["index.html", "python.html", "python_fields.html", "cpp/points.html", "formats.html"],
                wrong,
                pictures,
            )
            await search(tab, "winding", "open_winding.html", wrong)
            await search(tab, "MeshQuery", "cpp/points.html", wrong)
            for words in ("quickstart", "install", "tutorial"):
                await search(tab, words, "start.html", wrong, first=5)
            await search(tab, "watertight", "howto_watertight.html", wrong, first=5)
    if wrong:
        sys.exit("\n".join(wrong))
    print(f"{len(paths)} pages are as they should be on a phone and on a screen")


options = argparse.ArgumentParser(description=__doc__)
options.add_argument("folder", type=lambda text: Path(text).resolve())
options.add_argument("--pictures", type=Path)
given = options.parse_args()
if given.pictures:
    given.pictures.mkdir(parents=True, exist_ok=True)
asyncio.run(main(given.folder, given.pictures))
