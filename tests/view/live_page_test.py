# SPDX-License-Identifier: Apache-2.0
# labels: none
"""Pages that are alive, in a browser: fields that follow a slider, a mesh that is dropped, flights watched and recorded."""

import asyncio
import contextlib
import pathlib
import subprocess
import sys

from browser import browser
from program import run
from viewing import MESH, SOFTWARE, expect, failures, served

FLIGHT = ("--labyrinth", "scene:labyrinth:3000", "--speed", "5", "--flies", "6", "--mode", "thesis", "--minimum", "3")
here = pathlib.Path.cwd()


def served_quietly(*arguments):
    return served(*arguments, "--no-browser")


async def until(tab, script, what):
    for _ in range(1200):
        with contextlib.suppress(RuntimeError):
            if await tab.ask(script):
                return True
        await asyncio.sleep(0.05)
    expect(False, f"{what}; the page says {tab.complaints}")
    return False


async def opened(tab, address):
    await tab.size(900, 480)
    await tab.call("Page.navigate", url=address)
    await until(tab, "document.body && document.body.classList.contains('ready')", "the page starts")


async def slide(tab, label, value):
    await tab.ask(f"""(() => {{ const input = [...document.querySelectorAll('input[type=range]')].find(i => i.labels[0].textContent === '{label}');
      input.value = {value}; input.dispatchEvent(new Event('input')); }})()""")


async def choose(tab, value):
    await tab.ask(f"document.querySelector('input[type=radio][value={value}]').click()")


async def fields_follow_the_controls(tab, address):
    await opened(tab, address)
    size, thickness = "Math.max(...viewer.scene.field(0).size)", "viewer.scene.field(0).clamped * viewer.scene.field(0).step"
    expect(await tab.ask("[document.title, viewer.camera.up]") == ["a.obj", 1], "the title is the file's name, and y is up")
    expect(await tab.ask(size) == 24 and await tab.ask(thickness) == 0, "the first field is the one that was asked for")
    expect(await tab.ask("viewer.panel.scrollWidth <= viewer.panel.clientWidth"), "the controls fit their panel")
    await slide(tab, "Resolution", 5)
    await until(tab, f"{size} === 32", "the resolution follows its slider")
    await slide(tab, "Thickness", -1)
    await until(tab, f"Math.abs({thickness} - 0.2) < 0.01", "the thickness follows its slider")
    expect(await tab.ask("viewer.scene.field(0).range[0] < 0"), "it has a sign")
    await choose(tab, "none")
    await until(tab, "viewer.scene.field(0).range[0] >= 0", "so does the sign")
    # A click asks for the exact distance: the tetrahedron's corner region, whose nearest point is the corner.
    await tab.ask("viewer.pinned = {point: [-3, -4, -12], scene: [0, 0, 0], field: null, other: null, difference: null, triangle: null}, viewer.addExact(viewer.pinned)")
    await until(tab, "Math.abs(viewer.pinned.exact?.distance - 13) < 1e-12 && viewer.controls.point.element.textContent.includes('exact distance13')", "the exact distance is told")
    await tab.ask("viewer.look.mesh.shown = false, viewer.look.slices.forEach(s => { s.shown = true; }), viewer.changed(), viewer.settled()")
    await tab.ask("viewer.readAt(viewer.canvas.clientWidth / 2, viewer.canvas.clientHeight / 2)")
    await until(tab, "(({exact, field}) => exact && (field.clamped ? exact.distance > field.value - 0.1 : Math.abs(exact.distance - field.value) < 0.1))(viewer.pinned)", "a click reads the exact distance")
    # A drag: what comes last is what is shown, whatever became of the fields in between.
    for n in range(20):
        await slide(tab, "Thickness", -0.5 - 0.05 * n)
    await until(tab, f"Math.abs({thickness} - 2 * 10 ** -1.45) < 0.002", "after a drag the last value holds")
    await tab.ask("""(() => { const data = new DataTransfer();
      data.items.add(new File(['OFF\\n4 4 0\\n0 0 0\\n9 0 0\\n0 9 0\\n0 0 9\\n3 0 2 1\\n3 0 1 3\\n3 0 3 2\\n3 1 2 3\\n'], '<i>.off'));
      viewer.stage.dispatchEvent(new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true})); })()""")
    await until(tab, "viewer.scene.meshes.get('live').name === '<i>.off' && viewer.scene.field(0)?.box[1][0] > 8", "a mesh is dropped")
    expect(await tab.ask("viewer.camera.up") == 2, "it stands on its flattest base")


async def flights_are_watched(tab, address):
    await opened(tab, address)
    flight = "viewer.flight"
    await until(tab, f"{flight}.received > 5 && {flight}.bodies.length === 6", "frames come")
    await until(tab, f"{flight}.marks.length > 0", "fast flies pass through walls by the thesis")
    await choose(tab, "sweep")
    await asyncio.sleep(0.3)
    crossed = f"{flight}.bodies.reduce((sum, body) => sum + body.now.crossings, 0)"
    before = await tab.ask(crossed)
    seen = await tab.ask(f"{flight}.received")
    await until(tab, f"{flight}.received > {seen} + 20", "the flight goes on")
    expect(await tab.ask(crossed) == before, "swept flies pass through nothing")
    await slide(tab, "Flies", 1)
    await until(tab, f"{flight}.bodies.length === 10", "the number of flies follows its slider")


async def flights_are_shown_again(tab):
    done = run("fly", *FLIGHT, "--steps", "300", "--every", "3", "--json", "-o", "fly.html")
    crossings = int(done.stdout.split('"wall_crossings":')[1].split(",")[0])
    await opened(tab, (here / "fly.html").as_uri())
    await until(tab, "viewer.flight && viewer.flight.player", "the flight is there")
    await tab.ask("viewer.flight.player.pause(), viewer.flight.player.seek(0), viewer.flight.player.seek(100)")
    told = await tab.ask("Object.fromEntries([...viewer.flight.facts.element.children].map((e, n, all) => n % 2 ? [all[n - 1].textContent, e.textContent] : ['', '']))")
    expect(told["step"] == "300" and told["flies"] == "6", f"the end is the end: {told}")
    expect(crossings > 0 and told["wall crossings"] == str(crossings), f"crossings are counted: {crossings}, {told}")
    expect(await tab.ask("viewer.flight.marks.length") > 0, "and marked")
    inside = await tab.ask("""(() => { const [least, greatest] = viewer.scene.meshes.get('0').box;
      return viewer.flight.bodies.every(b => b.now.at.every((v, k) => v >= least[k] && v <= greatest[k])); })()""")
    expect(inside, "flies stay in the labyrinth's box")
    await tab.ask("viewer.flight.player.seek(10)")
    expect(await tab.ask("viewer.flight.bodies[0].points.length <= 11"), "going back shortens the paths")


async def main():
    (here / "a.obj").write_text(MESH)
    async with browser("", *SOFTWARE) as tab:
        with served_quietly("view", "a.obj", "-r", "24") as (program, address):
            await fields_follow_the_controls(tab, address)
            await tab.call("Page.navigate", url="about:blank")
            with contextlib.suppress(subprocess.TimeoutExpired):
                expect(await asyncio.to_thread(program.wait, 30) == 0, "the program ends with the page")
            expect(program.poll() is not None, "the program ends with the page")
        with served_quietly("fly", "--view", *FLIGHT) as (program, address):
            await flights_are_watched(tab, address)
            await tab.call("Page.navigate", url="about:blank")
        await flights_are_shown_again(tab)
        for complaint in tab.complaints:
            expect(False, complaint)
    sys.exit(1 if failures else 0)


asyncio.run(main())
