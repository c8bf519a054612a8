# SPDX-License-Identifier: Apache-2.0
# labels: none
"""The page that `standoff view` writes, in a browser: what it shows, what it says of points, and that it asks for nothing."""

import asyncio
import contextlib
import json
import math
import os
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(os.environ["STANDOFF_SOURCE_DIR"]) / "tests" / "support"))
from browser import browser  # noqa: E402

# Two tetrahedra: with a name that is no harm, and a shifted copy.
EVIL = "<img src=x onerror=alert(1)>.obj"
MESH = "v 0 0 0\nv 2 0 0\nv 0 1.5 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
here = pathlib.Path.cwd()
failures = []


def expect(condition, what):
    if not condition:
        failures.append(what)
        print(f"FAILED: {what}")


def standoff(*arguments):
    done = subprocess.run([os.environ["STANDOFF"], *arguments], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"standoff {' '.join(arguments)}: {done.stderr}")
    return done.stdout


def true_distance(point):
    """To the tetrahedron, by standoff points."""
    answer = subprocess.run([os.environ["STANDOFF"], "points", EVIL, "-", "--sign", "auto"], input=",".join(map(str, point)) + "\n",
                            capture_output=True, text=True)
    return float(answer.stdout.splitlines()[-1].split(",")[0])


class Page:
    def __init__(self, tab):
        self.tab = tab

    async def open(self, name, width=1280, height=800, phone=False, scheme="light"):
        await self.tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        await self.tab.size(width, height, phone)
        await self.tab.call("Page.navigate", url=(here / name).as_uri())
        for _ in range(1200):
            await asyncio.sleep(0.05)
            with contextlib.suppress(RuntimeError):
                if await self.tab.ask("document.body && (document.body.classList.contains('ready') || !document.getElementById('failure').hidden)"):
                    return
        raise SystemExit(f"{name}: the page does not start: {self.tab.complaints}")

    async def ask(self, script):
        return await self.tab.ask(script)

    async def mouse(self, kind, x, y, **more):
        await self.tab.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **{"button": "none", **more})

    async def drag(self, a, b, **more):
        await self.mouse("mouseMoved", *a)
        await self.mouse("mousePressed", *a, button="left", clickCount=1, buttons=1, **more)
        for n in range(1, 5):
            await self.mouse("mouseMoved", a[0] + (b[0] - a[0]) * n / 4, a[1] + (b[1] - a[1]) * n / 4, button="left", buttons=1, **more)
        await self.mouse("mouseReleased", *b, button="left", clickCount=1, **more)

    async def click(self, x, y):
        await self.drag((x, y), (x, y))

    async def key(self, key, **more):
        text = {"text": key} if len(key) == 1 else {}
        await self.tab.call("Input.dispatchKeyEvent", type="keyDown", key=key, **text, **more)
        await self.tab.call("Input.dispatchKeyEvent", type="keyUp", key=key, **more)

    async def camera(self):
        return await self.ask("(({azimuth, elevation, distance, target}) => ({azimuth, elevation, distance, target}))(viewer.camera)")


async def names_are_text(page):
    await page.open("page.html")
    expect(await page.ask("document.title") == EVIL, "the title is the file's name")
    expect(await page.ask("document.getElementById('names').textContent") == EVIL, "so is the heading")
    expect(await page.ask("document.images.length") == 0, "a name makes no picture")
    expect(await page.ask("document.querySelectorAll('script:not([type]), link[href^=http]').length") == 1, "there is one script")


async def pointers_and_keys(page):
    box = await page.ask("viewer.canvas.getBoundingClientRect().toJSON()")
    x, y = box["width"] / 2, box["height"] / 2
    before = await page.camera()
    await page.drag((x, y), (x + 80, y + 30))
    turned = await page.camera()
    expect(turned["azimuth"] < before["azimuth"] and turned["elevation"] > before["elevation"], "a drag turns")
    expect(turned["target"] == before["target"], "a drag does not move")
    await page.drag((x, y), (x + 80, y), modifiers=8)
    moved = await page.camera()
    expect(moved["target"] != turned["target"] and moved["azimuth"] == turned["azimuth"], "Shift and a drag move")
    await page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-240)
    await asyncio.sleep(0.1)
    expect((await page.camera())["distance"] < moved["distance"], "the wheel zooms")
    await page.key("r")
    expect((await page.camera())["distance"] != moved["distance"], "r shows all again")
    slices = "viewer.look.slices.map(s => s.shown)"
    first = await page.ask(slices)
    await page.key("x")
    second = await page.ask(slices)
    expect(second[0] != first[0] and second[1:] == first[1:], "x shows and hides a slice")
    expect(await page.ask("document.querySelector('#panel input[role=switch]').checked") == second[0], "its switch follows")
    at = await page.ask("viewer.look.slices.map(s => s.at)")
    await page.key("]")
    expect((await page.ask("viewer.look.slices.map(s => s.at)"))[0] > at[0], "] moves the slice")
    await page.key("x")
    await page.key("?")
    expect(await page.ask("document.getElementById('help').open"), "? opens help")
    await page.key("?")
    expect(not await page.ask("document.getElementById('help').open"), "and closes it")


async def sliders_and_handles(page):
    axis = await page.ask("viewer.look.slices.findIndex(s => s.shown)")
    await page.ask("viewer.settled()")
    place = await page.ask(f"viewer.handles.handles[{axis}].getBoundingClientRect().toJSON()")
    x, y = place["x"] + place["width"] / 2, place["y"] + place["height"] / 2
    before = await page.ask(f"viewer.look.slices[{axis}].at")
    await page.drag((x, y), (x + 40, y - 40))
    after = await page.ask(f"viewer.look.slices[{axis}].at")
    expect(abs(after - before) > 0.02, "a handle moves its slice")
    slider = f"viewer.controls.slices[{axis}].place.input"
    expect(abs(await page.ask(f"Number({slider}.value)") - after) < 1e-6, "the slider follows the handle")
    await page.ask(f"{slider}.focus()")
    await page.key("Home", code="Home", windowsVirtualKeyCode=36)
    expect(await page.ask(f"viewer.look.slices[{axis}].at") == 0, "a slider answers keys")
    await page.ask(f"viewer.look.slices[{axis}].at = 0.5, viewer.canvas.focus(), viewer.changed()")


async def values_are_true(page):
    """What a click says is the distance, as exact queries give it, within the interpolation's error."""
    await page.ask("viewer.look.mesh.shown = false, viewer.changed(), viewer.settled()")
    box = await page.ask("viewer.canvas.getBoundingClientRect().toJSON()")
    spacing = await page.ask("Math.max(...viewer.scene.field(0).spacing)")
    met = 0
    for dx, dy in ((0, 0), (-90, 30), (60, -70), (20, 110)):
        await page.click(box["width"] / 2 + dx, box["height"] / 2 + dy)
        told = await page.ask("viewer.pinned && {value: viewer.pinned.field.value, point: viewer.pinned.point, gradient: viewer.pinned.field.gradient,"
                              " triangle: viewer.pinned.field.triangle, text: document.querySelector('.section .facts dd').textContent}")
        if told is None:
            continue
        met += 1
        expect(abs(told["value"] - true_distance(told["point"])) < 0.9 * spacing, f"the value at {told['point']}")
        expect(0.5 < math.hypot(*told["gradient"]) < 1.3, f"the gradient at {told['point']} is a unit vector, nearly")
        expect(told["triangle"] in (0, 1, 2, 3), "the nearest triangle")
    expect(met >= 3, "clicks meet the slice")
    await page.ask("viewer.look.mesh.shown = true, viewer.changed()")
    corner = await page.ask("viewer.scene.meshes.values().next().value.hit([0.3, 0.3, -5], [0, 0, 1])")
    expect(corner["triangle"] == 0 and abs(corner["along"] - 5) < 1e-4, "a ray meets the mesh's first triangle")


async def data_is_the_programs(page):
    """Every 7th sample, against the field in another format."""
    told = await page.ask("(f => ({size: f.size, step: f.step, values: Array.from({length: Math.ceil(f.size[0] * f.size[1] * f.size[2] / 7)}, (_, m) => "
                          "{ const n = 7 * m; return f.value(n % f.size[0], Math.floor(n / f.size[0]) % f.size[1], Math.floor(n / f.size[0] / f.size[1])); })}))(viewer.scene.field(0))")
    text = (here / "field.nrrd").read_bytes()
    head, raw = text.split(b"\n\n", 1)
    import array

    expected = array.array("f")
    expected.frombytes(raw[: 4 * math.prod(told["size"])])
    worst = max(abs(a - b) for a, b in zip(told["values"], expected[::7]))
    expect(worst <= 1.6 * told["step"], f"values differ by {worst}, a step is {told['step']}")


async def can_be_used_by_all(page):
    """Names of controls, contrast of text, and that the picture's state is told."""
    nameless = await page.ask("""[...document.querySelectorAll('button, input, [role=button]')].filter(e =>
      !(e.getAttribute('aria-label') || e.labels?.[0]?.textContent || e.textContent.trim())).length""")
    expect(nameless == 0, "every control has a name")
    for scheme in ("light", "dark"):
        await page.ask(f"document.documentElement.dataset.theme = '{scheme}', viewer.readTheme()")
        worst = await page.ask(CONTRAST)
        expect(worst["ratio"] >= 4.5, f"contrast in {scheme}: {worst}")
    await page.ask("delete document.documentElement.dataset.theme, viewer.readTheme()")
    expect(await page.ask("document.querySelectorAll('[aria-live]').length") == 1, "what is read is told")


CONTRAST = """(() => {
  const canvas = new OffscreenCanvas(1, 1).getContext('2d', {willReadFrequently: true});
  const bytes = c => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = c; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
  const light = c => { const [r, g, b] = c.map(v => v / 255).map(v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const behind = e => { for (; e; e = e.parentElement) { const c = bytes(getComputedStyle(e).backgroundColor); if (c[3] > 250) return c.slice(0, 3); }
    return bytes(getComputedStyle(document.documentElement).getPropertyValue('--ground')).slice(0, 3); };
  let worst = {ratio: 99};
  for (const e of document.querySelectorAll('label, output, summary, dt, dd, h1, kbd, .label, .legend span, .legend .lines, .handle:not([hidden])')) {
    if (!e.textContent.trim() || !e.checkVisibility()) continue;
    const a = light(bytes(getComputedStyle(e).color).slice(0, 3)), b = light(behind(e));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < worst.ratio) worst = {ratio, text: e.textContent, kind: e.tagName + '.' + e.className};
  }
  return worst;
})()"""


async def main():
    (here / EVIL).write_text(MESH)
    standoff("compute", EVIL, "-r", "40", "--sign", "auto", "-o", "field.nrrd", "--uncompressed")
    told = json.loads(standoff("view", EVIL, "-r", "40", "--nearest", "--json", "-o", "page.html"))
    expect([h["name"] for h in told["holds"]] == [EVIL, f"field of {EVIL}"], "the program says what the page holds")
    async with browser("file://", *SOFTWARE) as tab:
        page = Page(tab)
        for check in (names_are_text, pointers_and_keys, sliders_and_handles, values_are_true, data_is_the_programs, can_be_used_by_all):
            await check(page)
        await page.open("page.html", 390, 844, phone=True, scheme="dark")
        expect(await page.ask("document.documentElement.scrollWidth") <= 390, "the page fits a phone")
        for complaint in tab.complaints:
            expect(False, complaint)
    sys.exit(1 if failures else 0)


asyncio.run(main())
