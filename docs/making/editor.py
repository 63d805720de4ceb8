"""Takes the pictures of an editor for docs/how-to/editors.md: `python docs/making/editor.py`.

The editor is Monaco, that of VS Code, with monaco-yaml and the real schema: what it completes and
underlines is what it finds. It needs the extra `dev`, a browser, and npm, which brings the editor.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

from PIL import Image

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "build" / "editor"
IMAGES = ROOT / "docs" / "images"
PACKAGES = {"monaco-editor": "0.52.2", "monaco-yaml": "5.5.1", "esbuild": "0.28.2"}
SIZE = {"width": 860, "height": 560}
LOW = {"width": 860, "height": 270}
COLOURS = 128

ENTRY = """\
import * as monaco from "monaco-editor";
import { configureMonacoYaml } from "monaco-yaml";
const worker = (_, label) => new Worker(label === "yaml" ? "yaml.js" : "editor.js");
window.MonacoEnvironment = { getWorker: worker };
window.openEditor = (schema, value) => {
  const known = [{ fileMatch: ["*"], schema, uri: "file:///mission.schema.json" }];
  configureMonacoYaml(monaco, { schemas: known });
  const options = { value, language: "yaml", fontSize: 15, minimap: { enabled: false } };
  window.editor = monaco.editor.create(document.body, { ...options, automaticLayout: true });
};
window.problems = () => monaco.editor.getModelMarkers({}).map((it) => it.message);
"""
PAGE = """\
<!doctype html><meta charset="utf-8"><link rel="stylesheet" href="entry.css">
<style>html, body { height: 100%; margin: 0 }</style><body><script src="entry.js"></script>
"""
TEXT = """\
# yaml-language-server: $schema=mission.schema.json
teamformer: 1
name: night shift
world: {grid: [16, 10]}
capabilities: [lift, scan]
robots:
  - {name: fork-1, at: [1, 2], can: [lift]}
  - {name: eye, at: [1, 7], can: [scan], sped: 2}
tasks:
  - name: pallet
    at: [12, 2]
    needs: {lift: 1}
    """


def bundle() -> None:
    """Fetch the editor by npm, and make scripts of it that a browser loads."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "package.json").write_text(json.dumps({"private": True, "dependencies": PACKAGES}))
    subprocess.run(
        ["npm", "install", "--silent", "--no-audit", "--no-fund"], cwd=FOLDER, check=True
    )
    (FOLDER / "entry.source.js").write_text(ENTRY)
    (FOLDER / "index.html").write_text(PAGE)
    sources = {
        "entry.js": "entry.source.js",
        "editor.js": "node_modules/monaco-editor/esm/vs/editor/editor.worker.js",
        "yaml.js": "node_modules/monaco-yaml/yaml.worker.js",
    }
    for name, source in sources.items():
        words = ("npx", "esbuild", source, "--bundle", f"--outfile={name}", "--loader:.ttf=dataurl")
        subprocess.run([*words, "--log-level=error"], cwd=FOLDER, check=True)


def take(page: Any, name: str) -> None:
    """Keep a picture of the page in few colours."""
    path = IMAGES / f"{name}.png"
    page.screenshot(path=path)
    with Image.open(path) as image:
        image.convert("RGB").quantize(COLOURS).save(path, optimize=True)
    print(path)


def pictures(address: str) -> None:
    """Take a picture of what is completed, and one of a mistake."""
    from playwright.sync_api import sync_playwright

    schema = json.loads((ROOT / "mission.schema.json").read_text(encoding="utf-8"))
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=["--no-sandbox"]
        )
        page = browser.new_page(viewport=SIZE, device_scale_factor=1.5)
        page.goto(address)
        page.evaluate("([schema, text]) => openEditor(schema, text)", [schema, TEXT])
        page.wait_for_function("problems().length > 0")
        print(page.evaluate("problems()"))
        page.evaluate("editor.setPosition({ lineNumber: 13, column: 5 }); editor.focus()")
        page.keyboard.press("Control+Space")
        page.wait_for_selector(".suggest-widget.visible .monaco-list-row")
        page.wait_for_timeout(500)
        if not page.is_visible(".suggest-details-container"):
            page.keyboard.press("Control+Space")
        page.wait_for_timeout(1000)
        take(page, "editor-completes")
        page.keyboard.press("Escape")
        page.set_viewport_size(LOW)
        page.wait_for_timeout(500)
        spot = page.locator(".squiggly-error, .squiggly-warning").first.bounding_box()
        page.mouse.move(spot["x"] + spot["width"] / 2, spot["y"] + spot["height"] / 2)
        page.wait_for_selector(".monaco-hover:not(.hidden) .hover-contents")
        page.wait_for_timeout(500)
        take(page, "editor-underlines")
        browser.close()


if __name__ == "__main__":
    bundle()
    handler = partial(SimpleHTTPRequestHandler, directory=str(FOLDER))
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    pictures(f"http://127.0.0.1:{server.server_port}/")
