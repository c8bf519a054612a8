# SPDX-License-Identifier: Apache-2.0
"""A page of standoff view in a tab of the browser: opened, pointed at, typed into, asked."""

import asyncio
import contextlib
import pathlib


class Page:
    def __init__(self, tab):
        self.tab = tab

    async def open(self, name, width=1280, height=800, phone=False, scheme="light"):
        await self.tab.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
        await self.tab.size(width, height, phone)
        file, *fragment = name.split("#", 1)
        await self.tab.call("Page.navigate", url="#".join([(pathlib.Path.cwd() / file).as_uri(), *fragment]))
        for _ in range(1200):
            await asyncio.sleep(0.05)
            with contextlib.suppress(RuntimeError):
                if await self.tab.ask("document.body && (document.body.classList.contains('ready') || !document.getElementById('failure').hidden)"):
                    await self.tab.ask("globalThis.viewer && (viewer.renderer.most = 2)")  # smooth enough, and done sooner
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
