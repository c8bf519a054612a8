# SPDX-License-Identifier: Apache-2.0
"""Pages in a browser without a graphics card: how large they are, how soon they show a picture, how smoothly they move, how
soon a live page shows a changed field, and how a flight streams. Uses the standoff program and Debian's Chromium."""

import asyncio
import base64
import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from harness import BENCH, machine_lines, markdown, results_folder, write_csv

sys.path.insert(0, str(BENCH.parent / "tests" / "support"))
BUNNY = "/usr/share/glmark2/models/bunny.obj"
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
SIZE = (1280, 800)
READY = "document.body?.classList.contains('ready') && globalThis.viewer?.renderer.shown === true"

# Turns for three seconds: [frames a second, the share of the canvas's width that is drawn, frames].
TURN = """new Promise(done => {
  const first = viewer.drawn, began = performance.now();
  const turn = now => {
    viewer.camera.turn(0.02, 0);
    viewer.changed();
    if (now - began < 3000) return requestAnimationFrame(turn);
    done([(viewer.drawn - first) * 1000 / (now - began), viewer.renderer.coarse, viewer.drawn - first]);
  };
  requestAnimationFrame(turn);
})"""
# Watches for three seconds: poses received and pictures drawn a second, the longest wait for a picture in seconds, the share,
# and how many pictures.
WATCH = """new Promise(done => {
  const {flight} = viewer, first = [flight.received, viewer.drawn], began = performance.now();
  let seen = viewer.drawn, at = began, longest = 0;
  const look = now => {
    if (viewer.drawn !== seen) {
      longest = Math.max(longest, now - at);
      [seen, at] = [viewer.drawn, now];
    }
    if (now - began < 3000) return requestAnimationFrame(look);
    const seconds = (now - began) / 1000;
    done([(flight.received - first[0]) / seconds, (viewer.drawn - first[1]) / seconds, longest / 1000, viewer.renderer.coarse, viewer.drawn - first[1]]);
  };
  requestAnimationFrame(look);
})"""
# Moves the slider of the thickness to 10^value of the longest side: milliseconds until the new field's first picture is there.
SLIDE = """new Promise(done => {
  const input = [...document.querySelectorAll('#panel .row.slider')].find(row => row.querySelector('label').textContent === 'Thickness').querySelector('input');
  const began = performance.now();
  let drawn = null;
  viewer.setUnpacked = function(...given) {
    delete viewer.setUnpacked;
    viewer.setUnpacked(...given);
    drawn = viewer.drawn;
  };
  input.value = VALUE;
  input.dispatchEvent(new Event('input', {bubbles: true}));
  const look = () => {
    if (drawn === null || viewer.drawn === drawn) return requestAnimationFrame(look);
    viewer.gl.readPixels(0, 0, 1, 1, viewer.gl.RGBA, viewer.gl.UNSIGNED_BYTE, new Uint8Array(4));
    done(performance.now() - began);
  };
  requestAnimationFrame(look);
})"""


def standoff(program, *arguments):
    subprocess.run([program, *map(str, arguments), "-q"], check=True)


async def processor(tab, pid=None):
    """Seconds that the browser, and a process, have taken so far."""
    told = await tab.call("SystemInfo.getProcessInfo", session=False)
    seconds = sum(process["cpuTime"] for process in told["processInfo"])
    if pid:
        numbers = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        seconds += sum(map(int, numbers[11:13])) / os.sysconf("SC_CLK_TCK")
    return seconds


async def costing(tab, script, pid=None):
    """What a script comes to, and the seconds of processor time that it took."""
    before = await processor(tab, pid)
    found = await tab.ask(script)
    return found, await processor(tab, pid) - before


@contextlib.contextmanager
def served(program, *arguments):
    """The process, and the address that it prints."""
    process = subprocess.Popen([program, *map(str, arguments), "--no-browser", "-q"], stdout=subprocess.PIPE, text=True)
    try:
        yield process.pid, process.stdout.readline().strip()
    finally:
        process.terminate()
        process.wait()


async def opened(tab, address):
    await tab.size(*SIZE)
    await tab.call("Page.navigate", url=address)
    for _ in range(2400):
        await asyncio.sleep(0.05)
        with contextlib.suppress(RuntimeError):
            if await tab.ask(READY):
                return
    raise SystemExit(f"bench: {address} does not start: {tab.complaints}")


async def rested(tab):
    """Leaves a page when its picture is whole: what is still being drawn of it would delay the next."""
    await tab.ask("globalThis.viewer?.settled()")
    await tab.call("Page.navigate", url="about:blank")
    await asyncio.sleep(0.5)


async def first_picture(tab, page, rounds, bound, goal):
    """From the beginning of loading, the median of some loads."""
    times, costs = [], []
    for _ in range(rounds):
        await rested(tab)
        before = await processor(tab)
        await opened(tab, page.as_uri())
        costs.append(await processor(tab) - before)
        times.append(await tab.ask("performance.getEntriesByName('first picture')[0].startTime") / 1000)
    return row("its first picture", statistics.median(times), 2, bound, goal, "s") | {"processor ms": f"{1000 * statistics.median(costs):.0f}"}


def row(what, value, digits, bound, goal, unit):
    """`bound` and `goal`: what is asked for; below or above, as the one who asked said."""
    shown = {"measured": what, "value": f"{value:.{digits}f}", "unit": unit, "asked for": bound}
    met = value <= float(bound[2:]) if bound.startswith("<") else value >= float(bound[2:])
    return shown | {"goal": goal, "met": "yes" if met else "no"}


async def turning(tab, bound="> 10"):
    await tab.ask("viewer.settled()")
    (smooth, share, count), cost = await costing(tab, TURN)
    return row("turning it", smooth, 1, bound, "", "frames a second") | {"processor ms": f"{1000 * cost / count:.0f}", "drawn at": f"{share:.2f}"}


# Of the mesh itself, and of what is drawn of the first mesh while it turns: places in the world, and where they are in the
# picture, in pixels; of the latter triangles and lines too.
STAND_IN = """(async () => {
  const {scene, camera, canvas} = viewer, [{data, standIn}] = scene.meshLayer.meshes.values(), {made} = standIn, [view] = viewer.views();
  const matrix = [...camera.matrix(viewer.aspectOf(view.rect), scene.radius)];
  const packed = numbers => new Promise(done => {
    const reader = new FileReader();
    reader.onload = () => done(reader.result.split(',')[1]);
    reader.readAsDataURL(new Blob([numbers]));
  });
  const places = lattice => packed(Float64Array.from(lattice, (v, n) => data.origin[n % 3] + data.step * v));
  return {matrix, center: [...scene.center], scale: scene.scale, half: [canvas.clientWidth / 2, canvas.clientHeight / 2], whole: await places(data.lattice),
    places: await places(made.lattice), triangles: await packed(made.triangles), lines: await packed(made.lines)};
})()"""


async def deviation(tab, program, folder):
    """The farthest that a vertex of the mesh is from what stands in for it while it turns, or the other way, in pixels of the
    picture: each against the point that is nearest in space."""
    told = await tab.ask(STAND_IN)
    whole, places = (np.frombuffer(base64.b64decode(told[name])).reshape(-1, 3) for name in ("whole", "places"))
    triangles, lines = (np.frombuffer(base64.b64decode(told[name]), "u4").reshape(-1, n) for name, n in (("triangles", 3), ("lines", 2)))
    with open(folder / "stand_in.obj", "w") as file:
        np.savetxt(file, places, "v %.17g %.17g %.17g")
        np.savetxt(file, np.vstack([triangles, lines[:, [0, 1, 1]]]) + 1, "f %d %d %d")

    def on_picture(points):
        seen = np.column_stack([(points - told["center"]) * told["scale"], np.ones(len(points))]) @ np.reshape(told["matrix"], (4, 4))
        return seen[:, :2] / seen[:, 3:] * told["half"]

    def farthest(points, mesh):
        np.save(folder / "points.npy", points)
        standoff(program, "points", mesh, folder / "points.npy", "--sign", "none", "--with", "closest", "-o", folder / "answers.npz", "-f")
        return np.linalg.norm(on_picture(points) - on_picture(np.load(folder / "answers.npz")["closest"]), axis=1).max()

    return max(farthest(whole, folder / "stand_in.obj"), farthest(places, "scene:factory"))


async def pages(tab, program, folder, rounds):
    bunny, factory = folder / "bunny.html", folder / "factory.html"
    standoff(program, "view", BUNNY, "-r", 128, "-t", "inf", "-o", bunny)
    yield row("page of the bunny with its full field, 128 samples: size", bunny.stat().st_size / 1e6, 2, "< 2", "", "MB")
    yield await first_picture(tab, bunny, rounds, "< 1", "< 0.5")
    await opened(tab, bunny.as_uri())
    yield await turning(tab)
    standoff(program, "view", "scene:factory", "-r", 128, "-o", factory)
    yield row("page of the factory with its field, 2.9 million triangles: size", factory.stat().st_size / 1e6, 2, "< 20", "", "MB")
    yield await first_picture(tab, factory, 1, "< 10", "")
    yield await turning(tab, "> 20")
    await tab.ask("viewer.frame(), viewer.settled()")
    yield row("the farthest that what turns is from the mesh, on the screen", await deviation(tab, program, folder), 1, "< 4", "", "pixels")


async def from_the_command(tab, program, rounds):
    """From starting the program to the first picture of its page, in a browser that runs."""
    times = []
    for _ in range(rounds):
        await rested(tab)
        began = time.time()
        with served(program, "view", BUNNY) as (_, address):
            await opened(tab, address)
            seen = await tab.ask("performance.timeOrigin + performance.getEntriesByName('first picture')[0].startTime")
            times.append(seen / 1000 - began)
    return row("live bunny: from the command to the first picture", statistics.median(times), 2, "< 0.7", "", "s")


async def live(tab, program, rounds):
    yield await from_the_command(tab, program, rounds)
    with served(program, "view", BUNNY, "-r", 128) as (pid, address):
        await opened(tab, address)
        await tab.ask("viewer.settled()")
        await tab.ask("viewer.panel.dispatchEvent(new PointerEvent('pointerdown', {bubbles: true}))")  # the slider is held
        for name, values in (("thin", [-1.5, -1.45, -1.4, -1.35, -1.3]), ("thick", [-0.5, -0.45, -0.4, -0.35, -0.3]), ("full", [-0.2, 0, -0.2, 0])):
            slid = [await costing(tab, SLIDE.replace("VALUE", str(value)), pid) for _ in range(rounds) for value in values]
            times, costs = ([one[n] for one in slid] for n in (0, 1))
            words = {"thin": "3 to 5 % of the longest side", "thick": "32 to 50 %", "full": "full fields"}[name]
            yield row(f"live bunny, 128 samples: from a new thickness to its picture, {words}", statistics.median(times) / 1000, 3, "< 0.3", "< 0.1",
                      "s") | {"processor ms": f"{1000 * statistics.median(costs):.0f}"}
        await tab.call("Page.navigate", url="about:blank")


async def flights(tab, program):
    for labyrinth in ("scene:labyrinth:20000", "scene:labyrinth"):
        with served(program, "fly", "--view", "--labyrinth", labyrinth, "--flies", 100, "--speed", 0.2) as (_, address):
            await opened(tab, address)
            await tab.ask("new Promise(done => setTimeout(done, 3000))")  # until paths are there and the picture has found its size
            (poses, drawn, longest, share, count), cost = await costing(tab, WATCH)
            yield row(f"flight of 100 flies in {labyrinth}: poses", poses, 1, "> 55", "", "a second")
            yield row("its pictures", drawn, 1, "> 10", "", "frames a second") | {
                "processor ms": f"{1000 * cost / count:.0f}", "drawn at": f"{share:.2f}", "longest wait, s": f"{longest:.2f}"}
            await tab.call("Page.navigate", url="about:blank")


async def measure(program, only, rounds):
    from browser import browser
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        parts = {"pages": lambda tab: pages(tab, program, Path(folder), rounds), "live": lambda tab: live(tab, program, rounds),
                 "flights": lambda tab: flights(tab, program)}
        for name, part in parts.items():
            if only and only not in name:
                continue
            async with browser("", *SOFTWARE) as tab:
                async for line in part(tab):
                    print(f"  {line['measured']}: {line['value']} {line['unit']}", file=sys.stderr)
                    rows.append(line)
    return rows


def run(build, only, rounds, note):
    program = Path(build) / "standoff"
    if not program.exists():
        raise SystemExit(f"bench: no {program}; build it with script/bench")
    loads = os.getloadavg()[1]
    rows = asyncio.run(measure(str(program), only, rounds or 3))
    print(markdown(rows))
    if only:
        return
    header = [*machine_lines(build), f"pages of {SIZE[0]} x {SIZE[1]} pixels, no graphics card: SwiftShader; load of the machine before: {loads:.1f}"]
    write_csv(results_folder() / "view.csv", header + ([note] if note else []), rows)
