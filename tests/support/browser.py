# SPDX-License-Identifier: Apache-2.0
"""A browser without a window, driven over its DevTools protocol; and a server of files for it."""

from __future__ import annotations

import asyncio
import functools
import inspect
import json
import os
import re
import shutil
import tempfile
from contextlib import asynccontextmanager, contextmanager
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread

import websockets


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_) -> None:
        pass


@contextmanager
def served(folder: Path):
    """The address of the folder's files, while it lasts."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(_Quiet, directory=str(folder)))
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()


class Tab:
    """A page of the browser. `complaints` collects what its console, its scripts and its requests complain of."""

    def __init__(self, socket, session: str, home: str) -> None:
        self._socket, self._session, self._home = socket, session, home
        self._answers: dict[int, asyncio.Future] = {}
        self._loaded = asyncio.Event()
        self._count = 0
        self.complaints: list[str] = []

    async def listen(self) -> None:
        async for message in self._socket:
            said = json.loads(message)
            if "id" in said:
                if (waiting := self._answers.pop(said["id"], None)) and not waiting.done():
                    waiting.set_result(said)
            elif said.get("sessionId") == self._session:
                self._hear(said["method"], said["params"])

    def _hear(self, method: str, told: dict) -> None:
        if method == "Page.loadEventFired":
            self._loaded.set()
        elif method == "Runtime.exceptionThrown":
            self.complaints.append(f"a script fails: {told['exceptionDetails'].get('text')}")
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.complaints.append(f"the console says: {[a.get('value', a.get('description')) for a in told['args']]}")
        elif method == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.complaints.append(f"the browser says: {told['entry']['text']} {told['entry'].get('url', '')}")
        elif method == "Network.requestWillBeSent":
            url = told["request"]["url"]
            if not url.startswith((self._home, "data:", "blob:")):
                self.complaints.append(f"asks the network for {url}")

    async def call(self, method: str, session: bool = True, **arguments):
        self._count += 1
        message = {"id": self._count, "method": method, "params": arguments}
        if session:
            message["sessionId"] = self._session
        answer = self._answers[self._count] = asyncio.get_running_loop().create_future()
        await self._socket.send(json.dumps(message))
        said = await asyncio.wait_for(answer, 60)
        if "error" in said:
            raise RuntimeError(f"{method}: {said['error']['message']}")
        return said["result"]

    async def open(self, path: str) -> None:
        self._loaded.clear()
        await self.call("Page.navigate", url=f"{self._home}/{path}")
        await asyncio.wait_for(self._loaded.wait(), 60)

    async def size(self, width: int, height: int, phone: bool = False) -> None:
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=phone
        )

    async def ask(self, script: str):
        """What a script's expression, or the promise that it makes, comes to."""
        said = await self.call("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in said:
            raise RuntimeError(said["exceptionDetails"])
        return said["result"].get("value")


@asynccontextmanager
async def browser(home: str, *arguments: str):
    """A tab of a new browser, started with `arguments` too, which may load what begins with `home`."""
    program = os.environ.get("CHROMIUM") or shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        raise SystemExit("no chromium; run script/bootstrap test")
    with tempfile.TemporaryDirectory(prefix="standoff-browser-", ignore_cleanup_errors=True) as profile:
        # No sandbox: root has none, and the pages are ours.
        process = await asyncio.create_subprocess_exec(
            program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--remote-debugging-port=0",
            f"--user-data-dir={profile}", *arguments, "about:blank",
            stderr=asyncio.subprocess.PIPE,
        )  # fmt: skip
        try:
            address = None
            while address is None:
                line = (await asyncio.wait_for(process.stderr.readline(), 60)).decode(errors="replace")
                if not line:
                    raise SystemExit("chromium ended before it began")
                if match := re.search(r"DevTools listening on (ws://\S+)", line):
                    address = match[1]
            drain = asyncio.create_task(_drain(process.stderr))
            # Debian's websockets knows no proxies, and newer ones must not use any.
            direct = {"proxy": None} if "proxy" in inspect.signature(websockets.connect).parameters else {}
            async with websockets.connect(address, max_size=None, **direct) as socket:
                tab = Tab(socket, "", home)
                listening = asyncio.create_task(tab.listen())
                target = (await tab.call("Target.createTarget", session=False, url="about:blank"))["targetId"]
                attached = await tab.call("Target.attachToTarget", session=False, targetId=target, flatten=True)
                tab._session = attached["sessionId"]
                for domain in ("Page", "Runtime", "Log", "Network"):
                    await tab.call(f"{domain}.enable")
                try:
                    yield tab
                finally:
                    listening.cancel()
                    drain.cancel()
        finally:
            process.terminate()
            await process.wait()


async def _drain(stream) -> None:
    while await stream.readline():
        pass
