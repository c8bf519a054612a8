# SPDX-License-Identifier: Apache-2.0
# labels: none
"""page_test.py [--update]: the page that `standoff view` writes, in a browser: what it shows, what it says of points, and that
it asks for nothing. --update draws the pictures anew that it is compared with."""

import array
import asyncio
import base64
import json
import math
import pathlib
import sys

from browser import browser
from page_pictures import COLORS, COMPARE, DRAWN, WHOLE
from page_tab import Page
from program import run
from viewing import MESH, SOFTWARE, expect, failures

# Two tetrahedra: with a name that is no harm, and a shifted copy.
EVIL = "<img src=x onerror=alert(1)>.obj"
here = pathlib.Path.cwd()


def true_distance(point):
    """To the tetrahedron, by standoff points."""
    answer = run("points", EVIL, "-", "--sign", "auto", input=",".join(map(str, point)) + "\n")
    return float(answer.stdout.splitlines()[-1].split(",")[0])


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
    await page.ask(f"viewer.look.slices[{axis}].at = 0.5, viewer.canvas.focus(), viewer.changed(), viewer.settled()")
    # The plane itself, gripped with Alt; without, the camera turns.
    at = await page.ask(f"""(() => {{ const {{scene, look}} = viewer, box = scene.sliceBox.map(p => scene.toScene(p)), p = box[0].map((v, k) => 0.8 * v + 0.2 * box[1][k]);
      viewer.look.mesh.shown = false;
      p[{axis}] = scene.slicePosition({axis});
      return viewer.placeOf(p, viewer.views()[0]); }})()""")
    camera = await page.camera()
    await page.drag(at, (at[0] + 40, at[1] - 40), modifiers=1)
    after = await page.ask(f"viewer.look.slices[{axis}].at")
    expect(abs(after - 0.5) > 0.02 and await page.camera() == camera, f"Alt and a drag move the slice: {after}")
    under = await page.ask(f"viewer.probe({at[0] + 40}, {at[1] - 40})?.kind")
    expect(under == "slice", f"it follows the pointer: {under}")
    await page.drag(at, (at[0] + 40, at[1] - 40))
    expect(await page.ask(f"viewer.look.slices[{axis}].at") == after and await page.camera() != camera, "without Alt the camera turns")
    await page.ask(f"viewer.look.slices[{axis}].at = 0.5, viewer.look.mesh.shown = true, viewer.frame(), viewer.settled()")


# What the layers are asked to draw, in the units that people read.
RECORD = """(() => {
  const {scene} = viewer, {meshLayer, sliceLayer} = scene, world = (axis, v) => v / scale() + scene.center[axis], scale = () => scene.scale;
  const drawn = globalThis.drawn = {};
  const drawMesh = meshLayer.draw.bind(meshLayer), drawSlices = sliceLayer.draw.bind(sliceLayer);
  meshLayer.draw = (id, frame, look, ...rest) => {
    const {range, clip} = frame.uniforms, axis = [0, 1, 2].find(k => clip[k] !== 0);
    if (typeof id === 'string') Object.assign(drawn, {opacity: look.opacity, color: look.color, range: range[1] / scale()});
    else drawn.isoOpacity = look.opacity;
    if (axis !== undefined) drawn.clip = world(axis, clip[3] / clip[axis]);
    return drawMesh(id, frame, look, ...rest);
  };
  sliceLayer.draw = (frame, box, planes, look) => {
    for (const {axis, where} of planes) drawn['xyz'[axis]] = world(axis, where);
    return drawSlices(frame, box, planes, look);
  };
})()"""
# Of each slider: what is drawn, as its text says it.
SLIDERS = {
    **{f"position of the slice across {axis}": f"drawn.{axis}" for axis in "xyz"},
    "value of the isosurface": "viewer.scene.surfaces.get(viewer.scene.field(0)).value",
    "opacity of the isosurface": "100 * drawn.isoOpacity",
    "how far from the surface samples are shown": "viewer.scene.pointsOf(viewer.scene.field(0)).band",
    "Range": "100 * drawn.range / Math.max(...viewer.scene.field(0).range.map(Math.abs))",
    "Opacity": "100 * drawn.opacity",
    "position of the clip plane": "drawn.clip",
}


async def readings_are_what_is_drawn(page):
    """Of every slider: its text, what a screen reader says, and what is drawn are one number, after each event."""
    await page.open("page.html")
    value, border, most = await page.ask("[viewer.look.iso.value, viewer.scene.field(0).borderLeast, viewer.scene.field(0).range[1]]")
    expect(0 < value < border < most, f"the isosurface begins within the grid: {value}, the border begins at {border}")
    said = await page.ask("""(() => {
      const {input} = viewer.controls.isoValue, text = () => input.getAttribute('aria-valuetext');
      return ['least', 'most'].map(which => {
        input.value = which === 'least' ? viewer.scene.field(0).borderLeast * 0.99 : input.max;
        input.dispatchEvent(new Event('input'));
        return text();
      });
    })()""")
    cut = await page.ask("""(() => {
      const field = viewer.scene.field(0), up = viewer.camera.up, upright = viewer.look.mesh.cut;
      viewer.camera.up = field.plane, viewer.chooseSlice(field);
      const lying = viewer.look.mesh.cut;
      viewer.camera.up = up, viewer.chooseSlice(field);
      return [upright, lying];
    })()""")
    expect(cut == [True, False], f"a slice cuts the mesh, unless what it would take away stands on it: {cut}")
    expect("cut off" not in said[0] and "cut off by the grid" in said[1], f"a surface that the grid cuts off is told: {said}")
    await page.ask(f"({RECORD}, viewer.look.slices.forEach(s => {{ s.shown = true; }}), viewer.look.iso.shown = viewer.look.points.shown = viewer.look.clip.shown = true,"
                   " viewer.look.mesh.cut = false, viewer.rebuild(), viewer.settled())")
    names = await page.ask("[...document.querySelectorAll('#panel input[type=range]')].map(i => i.getAttribute('aria-label') ?? i.labels[0].textContent)")
    expect(sorted(names) == sorted(SLIDERS), f"every slider is tested: {names}")
    for name in names:
        for share in (0.3, 0.7, 0.42):
            told = await page.ask(f"""(async () => {{
              const input = [...document.querySelectorAll('#panel input[type=range]')].find(i => (i.getAttribute('aria-label') ?? i.labels[0].textContent) === '{name}');
              input.value = Number(input.min) + {share} * (input.max - input.min);
              input.dispatchEvent(new Event('input'));
              const text = input.parentElement.querySelector('output').textContent, said = input.getAttribute('aria-valuetext');
              await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)));
              await viewer.settled();
              return [text, said, {SLIDERS[name]}];
            }})()""")
            number = float(told[0].replace("−", "-").split(",")[0].split(" ")[0])
            expect(told[0] == told[1], f"{name}: a screen reader says {told[1]}, the text is {told[0]}")
            expect(abs(number - told[2]) <= (0.51 if "%" in told[0] else 0.006 * abs(told[2]) + 1e-4), f"{name}: the text is {told[0]}, {told[2]} is drawn")
    limits = await page.ask("""(async () => {
      const [a, b] = viewer.controls.limits.inputs;
      a.value = '−0.25'; b.value = '0.5'; b.dispatchEvent(new Event('change'));
      await viewer.settled();
      const typed = [...viewer.views()[0].range, drawn.range];
      b.value = 'x'; b.dispatchEvent(new Event('change'));
      return [typed, b.value];
    })()""")
    expect(limits == [[-0.25, 0.5, 0.5], "0.5"], f"typed limits are those of the colours, and what is no number is none: {limits}")


async def meshes_have_colors_of_their_own(page):
    await page.open("page.html")
    told = await page.ask(f"""({RECORD}, (async () => {{
      const {{picker, input}} = viewer.controls.meshes.get('0');
      picker.value = '#ff8000';
      picker.dispatchEvent(new Event('input'));
      await viewer.settled();
      const color = drawn.color;
      drawn.color = null;
      input.click();
      await viewer.settled();
      return [color, drawn.color];
    }})())""")
    expect(told[0] and max(abs(a - b) for a, b in zip(told[0], (1, 0.502, 0))) < 0.01 and told[1] is None, f"a colour, and away: {told}")


async def links_keep_the_view(page):
    """The address of a view shows it again; one that says nonsense shows what there is."""
    await page.open("page.html")
    seen = "JSON.stringify([viewer.camera, viewer.look.slices.map(s => [s.shown, s.at]), viewer.look.clip, viewer.look.meshes, viewer.look.mesh.opacity, viewer.look.range])"
    link = await page.ask("(viewer.camera.turn(0.4, 0.2), viewer.look.slices[0].shown = true, viewer.look.clip.shown = true, viewer.look.mesh.opacity = 0.5,"
                          " viewer.look.meshes['0'] = {hidden: true}, viewer.look.range = [-1, 2], viewer.keepView().then(() => location.hash))")
    before = await page.ask(seen)
    await page.open("single.html")
    await page.open("page.html" + link)
    after = await page.ask(seen)
    rounded = [json.loads(text, parse_float=lambda v: round(float(v), 5)) for text in (before, after)]
    expect(rounded[0] == rounded[1], f"a link shows what was seen: {before}, {after}")
    for nonsense in ("%", "null", "[]", '{"look":{"comparison":"x","colormap":7,"clip":{"axis":9},"__proto__":{"a":1},"range":[3,1]},"camera":{"up":5,"distance":-3}}',
                     '{"look":{"slices":{"length":4000000000},"edgeColor":{"length":-2}}}', '{"camera":{"target":{"length":0,"1":1e308}}}'):
        await page.open("single.html")
        await page.open("page.html#view=" + nonsense.replace('"', "%22"))
        expect(await page.ask("document.getElementById('failure').hidden && viewer.gl.getError() === 0 && viewer.look.clip.axis < 3"), f"nonsense does no harm: {nonsense}")


async def distances_are_measured(page):
    await page.open("page.html")
    told = await page.ask("""(() => {
      viewer.look.mesh.shown = false;
      const [w, h] = [viewer.canvas.clientWidth, viewer.canvas.clientHeight];
      viewer.measure(true);
      const a = viewer.readAt(w / 2, h / 2), b = viewer.readAt(w / 2 + 60, h / 2 + 20);
      const dd = Object.fromEntries([...viewer.controls.point.element.children].map((e, n, all) => n % 2 ? [all[n - 1].textContent, e.textContent] : ['', '']));
      viewer.measure(false);
      return [Math.hypot(...a.point.map((v, k) => v - b.point[k])), Number(dd.length)];
    })()""")
    expect(told[0] > 0.01 and abs(told[0] - told[1]) < 1e-4, f"the distance of two points: {told}")


async def up_is_what_the_mesh_says(page):
    await page.open("page.html")
    expect(await page.ask("viewer.camera.up") == 1, "an OBJ file has y up")
    await page.key("u")
    expect(await page.ask("[viewer.camera.up, viewer.controls.up.element.querySelector('input:checked').value]") == [2, "2"], "u takes the next axis, and the control follows")
    await page.open("odd.html")
    expect(await page.ask("viewer.camera.up") == 1, "so has a field that was made of one")


async def stand_ins_keep_beams(page):
    """Of a large mesh fewer triangles are drawn while it moves; a beam thinner than a cell becomes a line; frames that take
    too long make them fewer, frames that leave time more."""
    await page.open("page.html")
    told = await page.ask("""(() => {
      const n = 300, lattice = [], corners = [], layer = viewer.scene.meshLayer;
      for (let j = 0; j <= n; ++j) for (let i = 0; i <= n; ++i)
        lattice.push(Math.round(65535 * i / n), Math.round(65535 * j / n), Math.round(3000 + 2500 * Math.sin(i / 9) * Math.cos(j / 11)));
      for (let j = 0; j < n; ++j) for (let i = 0; i < n; ++i) {
        const a = i + (n + 1) * j, b = a + 1, c = a + n + 1, d = c + 1;
        corners.push(a, b, c, b, d, c);
      }
      for (let k = 0; k <= 500; ++k) for (const [y, z] of [[0, 0], [40, 0], [20, 40]]) lattice.push(Math.round(65535 * k / 500), 30020 + y, 40020 + z);
      const first = (n + 1) * (n + 1);
      for (let k = 0; k < 500; ++k) for (let s = 0; s < 3; ++s) {
        const a = first + 3 * k + s, b = first + 3 * k + (s + 1) % 3;
        corners.push(a, b, a + 3, b, b + 3, a + 3);
      }
      const data = Object.create(Object.getPrototypeOf(viewer.scene.meshes.get('0')));
      Object.assign(data, {name: 'large', bits: 16, origin: [0, 0, 0], step: 1 / 65535, lattice: Uint16Array.from(lattice), corners: Uint32Array.from(corners),
        vertices: lattice.length / 3, triangles: corners.length / 3, proxy: 0, proxyCorners: new Uint32Array(0), box: [[0, 0, 0], [1, 1, 1]], chunks: null});
      layer.set('large', data);
      const mesh = layer.meshes.get('large'), sizes = [mesh.size], lines = mesh.standIn.lines, thins = layer.thins('large');
      layer.resize(false), layer.resize(false);
      sizes.push(mesh.size);
      for (let k = 0; k < 3; ++k) layer.resize(true);
      sizes.push(mesh.size);
      for (let k = 0; k < 3; ++k) layer.resize(true);
      const whole = !layer.thins('large');
      layer.set('large', null);
      layer.budget = 70000;
      return {sizes, lines, thins, whole};
    })()""")
    first, fewer, more = told["sizes"]
    expect(told["thins"] and 40 <= told["lines"] < first, f"a beam becomes lines: {told}")
    expect(fewer <= first < more and first < 105000, f"stand-ins follow the time that frames take: {told}")
    expect(told["whole"], f"where there is time, the mesh itself is drawn: {told}")


async def fingers(page):
    """Two fingers zoom and move; one turns; one on a handle moves its slice."""
    await page.tab.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)

    async def touch(kind, *places):
        await page.tab.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": n} for n, (x, y) in enumerate(places)])

    box = await page.ask("viewer.canvas.getBoundingClientRect().toJSON()")
    x, y = box["width"] / 2, box["height"] / 2
    before = await page.camera()
    await touch("touchStart", (x - 40, y), (x + 40, y))
    for n in range(1, 6):
        await touch("touchMove", (x - 40 - 16 * n, y), (x + 40 + 16 * n, y))
    await touch("touchEnd")
    pinched = await page.camera()
    expect(abs(pinched["distance"] / before["distance"] - 1 / 3) < 0.05, f"fingers three times as far apart bring it three times as near: {before}, {pinched}")
    expect(pinched["azimuth"] == before["azimuth"] and pinched["elevation"] == before["elevation"], "and turn nothing")
    await touch("touchStart", (x - 40, y), (x + 40, y))
    for n in range(1, 6):
        await touch("touchMove", (x - 40 + 10 * n, y), (x + 40 + 10 * n, y))
    await touch("touchEnd")
    moved = await page.camera()
    expect(moved["target"] != pinched["target"] and abs(moved["distance"] / pinched["distance"] - 1) < 0.3, "two fingers move")
    await touch("touchStart", (x, y))
    for n in range(1, 6):
        await touch("touchMove", (x + 10 * n, y))
    await touch("touchEnd")
    expect((await page.camera())["azimuth"] < moved["azimuth"], "one finger turns")
    await page.ask("viewer.frame(), viewer.settled()")
    axis = await page.ask("viewer.look.slices.findIndex(s => s.shown)")
    place = await page.ask(f"viewer.handles.handles[{axis}].getBoundingClientRect().toJSON()")
    at, old = (place["x"] + place["width"] / 2, place["y"] + place["height"] / 2), await page.ask(f"viewer.look.slices[{axis}].at")
    await touch("touchStart", at)
    for n in range(1, 6):
        await touch("touchMove", (at[0] + 8 * n, at[1] - 8 * n))
    await touch("touchEnd")
    expect(abs(await page.ask(f"viewer.look.slices[{axis}].at") - old) > 0.02, "a finger on a handle moves its slice")
    await page.ask(f"viewer.look.slices[{axis}].at = 0.5, viewer.changed()")
    await page.tab.call("Emulation.setTouchEmulationEnabled", enabled=False)


async def pictures_are_saved(page):
    """The button writes a PNG file of what is seen, as large as the canvas."""
    await page.tab.call("Browser.setDownloadBehavior", session=False, behavior="allow", downloadPath=str(here))
    await page.ask("viewer.settled()")
    await page.ask("[...document.querySelectorAll('#toolbar button')].find(b => b.title === 'save the picture').click()")
    saved = here / "standoff.png"
    for _ in range(600):
        if saved.exists():
            break
        await asyncio.sleep(0.05)
    expect(saved.exists(), "the button saves a file")
    picture = "data:image/png;base64," + base64.b64encode(saved.read_bytes()).decode()
    off = await page.ask(f"({COMPARE})({json.dumps(picture)}, {WHOLE})")
    expect(off < 1, f"it holds the picture: {off}")
    colors = await page.ask(f"({COLORS})({json.dumps(picture)})")
    expect(colors > 200, f"which is not empty: {colors} colours")


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
    expected = array.array("f")
    expected.frombytes(raw[: 4 * math.prod(told["size"])])
    worst = max(abs(a - b) for a, b in zip(told["values"], expected[::7]))
    expect(worst <= 1.6 * told["step"], f"values differ by {worst}, a step is {told['step']}")


async def surfaces_are_where_the_value_is(page):
    """Each vertex has the value, within what a cell's middle is off by; the surface is closed, and faces outwards."""
    told = await page.ask("""(() => {
      const field = viewer.scene.field(0), spacing = Math.max(...field.spacing);
      viewer.look.iso.value = spacing;
      const mesh = viewer.scene.surface(field), edges = new Map();
      let off = 0, volume = 0;
      for (let n = 0; n < mesh.vertices; ++n) off = Math.max(off, Math.abs(field.at(mesh.vertex(n)).value - spacing));
      for (let n = 0; n < mesh.triangles; ++n) {
        const [a, b, c] = mesh.triangle(n);
        volume += (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6;
        for (let k = 0; k < 3; ++k) {
          const [u, v] = [mesh.corners[3 * n + k], mesh.corners[3 * n + (k + 1) % 3]], key = `${Math.min(u, v)} ${Math.max(u, v)}`;
          edges.set(key, (edges.get(key) ?? 0) + (u < v ? 1 : -1));
        }
      }
      return {triangles: mesh.triangles, off: off / spacing, volume, open: [...edges.values()].filter(n => n !== 0).length};
    })()""")
    expect(told["triangles"] > 500 and told["off"] < 0.3, f"vertices have the value: {told}")
    expect(told["open"] == 0 and told["volume"] > 0.5, f"the isosurface is closed and faces outwards: {told}")
    told = await page.ask("""(() => {
      const field = viewer.scene.field(0), [nx, ny, nz] = field.size;
      viewer.look.points.band = 2 * field.spacing[0];
      let near = 0;
      for (let k = 0; k < nz; ++k) for (let j = 0; j < ny; ++j) for (let i = 0; i < nx; ++i)
        near += Math.abs(field.value(i, j, k)) <= viewer.look.points.band;
      return [viewer.scene.pointsOf(field).count, near];
    })()""")
    expect(told[0] == told[1] > 100, f"points are the samples near the surface: {told}")


async def bodies_stand_where_poses_say(page):
    told = await page.ask("""(() => {
      viewer.setBodies('0', [{}, {color: [1, 0, 0]}]);
      viewer.setPoses('0', Float32Array.of(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 5, 1, 0, 0, 0, 0, 0, 1, 0));
      const [one, two] = viewer.scene.bodies.get('0').map(b => [...b.matrix]), {scene} = viewer;
      viewer.setBodies('0', null);
      const p = scene.toScene([0.3, 0.2, 0.1]), moved = [0, 1, 2].map(k => two[k] * p[0] + two[4 + k] * p[1] + two[8 + k] * p[2] + two[12 + k]);
      return [one, scene.toWorld(moved)];
    })()""")
    expect(all(abs(v - (n % 5 == 0)) < 1e-6 for n, v in enumerate(told[0])), f"no pose moves nothing: {told[0]}")
    expect(max(abs(a - b) for a, b in zip(told[1], (4.8, 0.3, 0.1))) < 1e-5, f"a pose moves and turns: {told[1]}")


async def two_fields_and_their_difference(page):
    await page.open("two.html")
    views = await page.ask("viewer.views().map(v => [v.fields.map(f => f.name), v.difference])")
    expect(views == [[["field.nrrd"], False], [["band.vti"], False], [["field.nrrd", "band.vti"], True]], f"three views: {views}")
    told = await page.ask("(([a, b]) => { const p = [0.4, 0.4, 0.02]; return [a.at(p).value, b.at(p).value]; })([...viewer.scene.fields.values()])")
    box = await page.ask("viewer.canvas.getBoundingClientRect().toJSON()")
    await page.ask("viewer.look.mesh.shown = false, viewer.look.comparison = 'difference', viewer.changed(), viewer.settled()")
    await page.click(box["width"] / 2, box["height"] / 2 + 20)
    read = await page.ask("viewer.pinned && [viewer.pinned.difference, viewer.pinned.field.value - viewer.pinned.other.value]")
    expect(read is not None and read[0] == read[1] and abs(told[0] - told[1]) < 0.1, f"a click reads the difference: {read}")
    expect(await page.ask("document.querySelectorAll('.legend:not([hidden])').length") == 1, "one legend for one view")


async def odd_data_is_shown(page):
    for name in ("odd.html", "huge.html", "tiny.html", "alone.html", "single.html"):
        await page.open(name, 520, 400)
        await page.ask("viewer.look.iso.shown = viewer.look.points.shown = true, viewer.look.slices.forEach(s => { s.shown = true; }), viewer.changed(), viewer.settled()")
        expect(await page.ask("viewer.gl.getError()") == 0, f"{name}: the graphics complain of nothing")
        expect(await page.ask("document.getElementById('failure').hidden"), f"{name}: the page shows something")
    await page.open("odd.html")
    told = await page.ask("(f => [0, 1, 2].map(n => String(f.value(n, 0, 0))))(viewer.scene.field(0))")
    expect(told[:2] == ["Infinity", "-Infinity"], f"infinite values stay so: {told}")


async def looks_as_it_did(page):
    """The picture, without what lies over it, at a sixth of its size: fonts and their edges are the machine's."""
    folder = pathlib.Path(__file__).parent / "pictures"
    for name, scheme, look in (("light", "light", "0"),
                               ("dark", "dark", "look.mesh.cut = look.points.shown = true, look.slices.forEach(s => { s.shown = true; })"),
                               ("surface", "light", "look.mesh.shown = look.mesh.cut = false, look.iso.shown = true, look.iso.value = 0.2, look.colormap = 'thesis'")):
        await page.open("page.html", 900, 600, scheme=scheme)
        await page.ask(f"(look => {{ {look}; }})(viewer.look), viewer.changed(), viewer.settled()")
        drawn = await page.ask(DRAWN)
        reference = folder / f"{name}.png"
        if "--update" in sys.argv:
            folder.mkdir(exist_ok=True)
            reference.write_bytes(base64.b64decode(drawn.split(",")[1]))
        expected = "data:image/png;base64," + base64.b64encode(reference.read_bytes()).decode()
        off = await page.ask(f"({COMPARE})({json.dumps(drawn)}, {json.dumps(expected)})")
        expect(off < 2.5, f"the picture {name} differs from {reference} by {off} of 255 on average")


async def stored_tiles_look_like_a_dense_texture(page):
    """Fields that are too large for a texture of the grid's size are drawn out of their stored tiles."""
    drawn = []
    for samples in (2000, 3000):
        await page.open(f"long{samples}.html", 700, 500)
        await page.ask("viewer.look.mesh.shown = false, viewer.look.contours = false, viewer.look.slices.forEach(s => { s.shown = true; }), viewer.changed(), viewer.settled()")
        drawn.append(await page.ask(DRAWN))
        slots = await page.ask("[...viewer.scene.textures.values()][0].slots[0]")
        expect((slots > 0) == (samples == 3000), f"{samples} samples along an axis: {slots} slots")
    off = await page.ask(f"({COMPARE})({json.dumps(drawn[0])}, {json.dumps(drawn[1])})")
    expect(off < 1, f"the same of stored tiles: {off}")


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
    run("compute", EVIL, "-r", "40", "--sign", "auto", "-o", "field.nrrd", "--uncompressed")
    told = json.loads(run("view", EVIL, "-r", "40", "--nearest", "--json", "-o", "page.html").stdout)
    expect([h["name"] for h in told["holds"]] == [EVIL, f"field of {EVIL}"], "the program says what the page holds")
    run("compute", EVIL, "-r", "30", "--sign", "auto", "-t", "4s", "-o", "band.vti")
    run("view", EVIL, "field.nrrd", "band.vti", "-o", "two.html")
    head, values = (here / "field.nrrd").read_bytes().split(b"\n\n", 1)
    odd = array.array("f", (math.inf, -math.inf, -3.0))
    (here / "odd.nrrd").write_bytes(head + b"\n\n" + odd.tobytes() + values[12:])
    run("view", "odd.nrrd", "-o", "odd.html")
    for name, unit in (("huge", "e30"), ("tiny", "e-30")):
        (here / f"{name}.obj").write_text("".join(f"v {a}{unit} {b}{unit} {c}{unit}\n" for a, b, c in ((0, 0, 0), (2, 0, 0), (0, 1, 0), (0, 0, 1))) + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
        run("view", f"{name}.obj", "-r", "20", "-o", f"{name}.html")
    for samples in (2000, 3000):
        run("view", EVIL, "--size", f"{samples},24,24", "-t", "0.3", "-o", f"long{samples}.html")
    run("view", EVIL, "--no-field", "-o", "alone.html")
    run("view", "scene:one_triangle", "--size", "1,1,1", "-o", "single.html")
    async with browser("file://", *SOFTWARE) as tab:
        page = Page(tab)
        for check in (names_are_text, pointers_and_keys, sliders_and_handles, fingers, pictures_are_saved, values_are_true, data_is_the_programs,
                      surfaces_are_where_the_value_is, bodies_stand_where_poses_say, can_be_used_by_all, readings_are_what_is_drawn,
                      meshes_have_colors_of_their_own, links_keep_the_view, distances_are_measured, up_is_what_the_mesh_says, stand_ins_keep_beams, looks_as_it_did,
                      two_fields_and_their_difference, stored_tiles_look_like_a_dense_texture, odd_data_is_shown):
            await check(page)
        await page.open("page.html", 390, 844, phone=True, scheme="dark")
        expect(await page.ask("document.documentElement.scrollWidth") <= 390, "the page fits a phone")
        for complaint in tab.complaints:
            expect(False, complaint)
    sys.exit(1 if failures else 0)


asyncio.run(main())
