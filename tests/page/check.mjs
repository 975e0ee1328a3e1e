// Whether the page of `umbrage check --html` works in a browser: Chromium opens it as a file, a script appended to a
// copy presses keys and looks at the picture, and the results are read from the document.
//
//   node tests/page/check.mjs target/debug/umbrage
//
// Needs Chromium (or CHROMIUM, its path). Says so where it cannot run, and then exits with 0; with REQUIRE_PAGE=1 it
// fails.

import { execFileSync, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";

if (!process.argv[2]) throw new Error("name the command: node tests/page/check.mjs target/debug/umbrage");
// It runs in a folder of its own.
const umbrage = resolve(process.argv[2]);
const chromium =
  process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!chromium || !existsSync(chromium)) {
  console.log("SKIPPED page: no Chromium; set CHROMIUM to its path");
  process.exit(process.env.REQUIRE_PAGE === "1" ? 1 : 0);
}
const folder = mkdtempSync(join(tmpdir(), "umbrage-page-"));

// A box without its upper side; beside it two triangles that share two vertices the wrong way round, and a tiny one.
const box = `v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 4 1 5\nf 4 5 8
v 3 -1 0\nv 5 -1 0\nv 3 1 0\nv 5 1 0\nf 9 10 11\nf 9 10 12\nv 2 0 0\nv 2.01 0 0\nv 2 0.01 0\nf 13 14 15\n`;
writeFileSync(join(folder, "box.obj"), box);
const run = spawnSync(umbrage, ["check", "box.obj", "--html", "box.html", "--quiet"], { cwd: folder, encoding: "utf8" });
if (run.status !== 1) throw new Error(run.error ?? run.stderr);

// Presses keys, and tells how many pixels are of a color near that of the first kind, before and after.
const probe = `<script>
addEventListener("load", () => {
  const root = document.documentElement, found = {};
  const press = (key) => document.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
  const pixels = () => {
    view.draw();
    const gl = view.canvas.getContext("webgl2"), [w, h] = [view.canvas.width, view.canvas.height];
    const bytes = new Uint8Array(4 * w * h);
    gl.readPixels(0, 0, w, h, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    let [red, gray] = [0, 0];
    for (let i = 0; i < bytes.length; i += 4) {
      const [r, g, b] = bytes.subarray(i, i + 3);
      if (r > 180 && g < 80 && b < 80) red++;
      if (Math.abs(r - g) < 12 && Math.abs(g - b) < 12 && r > 60 && r < 215) gray++;
    }
    return { red, gray, error: gl.getError() };
  };
  try {
    if (view) found.whole = pixels();
    press("ArrowDown"); found.first = root.dataset.selected;
    press("ArrowDown"); found.second = root.dataset.selected;
    press("ArrowUp"); found.back = root.dataset.selected;
    document.querySelectorAll("tr.defect")[2].click(); found.clicked = root.dataset.selected;
    if (view) {
      found.near = pixels();
      document.querySelector(".kinds input").click(); found.off = pixels();
      document.querySelector(".kinds input").click();
    }
    press("Escape"); found.reset = root.dataset.selected ?? "none";
    found.view = root.dataset.view;
    found.shown = !document.querySelector(".view").hidden;
    found.missing = !document.querySelector(".missing").hidden;
  } catch (error) { found.error = String(error); }
  const out = document.createElement("pre");
  out.id = "found"; out.textContent = "FOUND" + JSON.stringify(found) + "END";
  document.body.append(out);
});
</script>`;
const html = readFileSync(join(folder, "box.html"), "utf8");
writeFileSync(join(folder, "probe.html"), html.replace("</body>", `${probe}</body>`));

function open(flags) {
  const all = ["--headless=new", "--no-sandbox", "--no-first-run", "--disable-extensions", "--disable-quic"];
  all.push("--disable-background-networking", "--disable-component-update", "--disable-sync", "--force-prefers-reduced-motion");
  all.push(`--user-data-dir=${mkdtempSync(join(folder, "profile-"))}`, "--window-size=1280,900", "--virtual-time-budget=2000");
  const text = execFileSync(chromium, [...all, ...flags, "--dump-dom", `file://${join(folder, "probe.html")}`], {
    encoding: "utf8", stdio: ["ignore", "pipe", "ignore"], timeout: 60_000, maxBuffer: 1 << 26,
  });
  // The last one: the first stands in the script that writes it.
  const at = text.lastIndexOf("FOUND{");
  if (at < 0) throw new Error(`the page did not answer: ${text.slice(-3000)}`);
  return JSON.parse(text.slice(at + 5, text.indexOf("END", at)).replaceAll("&amp;", "&").replaceAll("&lt;", "<").replaceAll("&gt;", ">"));
}

let failed = 0;
function expect(what, holds, found) {
  if (holds) return;
  failed++;
  console.log(`FAILED page: ${what}: ${JSON.stringify(found)}`);
}
const drawn = open(["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]);
expect("no error", drawn.error === undefined, drawn);
expect("the keys step", drawn.first === "0" && drawn.second === "1" && drawn.back === "0" && drawn.reset === "none", drawn);
expect("a click chooses", drawn.clicked === "2", drawn);
if (drawn.view === "webgl") {
  expect("the mesh and its red lines are drawn", drawn.whole.gray > 5000 && drawn.whole.red > 100, drawn);
  expect("nothing is wrong with WebGL", drawn.whole.error === 0 && drawn.near.error === 0, drawn);
  expect("the tiny triangle fills the view once it is chosen", drawn.near.gray > 1.5 * drawn.whole.gray, drawn);
  // Fault injected: without its kind, no line is red.
  expect("a kind that is switched off is gone", drawn.near.red > 1000 && drawn.off.red === 0, drawn);
} else {
  console.log("SKIPPED page: this Chromium has no WebGL 2");
  if (process.env.REQUIRE_PAGE === "1") failed++;
}
const plain = open(["--disable-gpu", "--disable-3d-apis"]);
expect("without WebGL it says so, and the keys step", plain.view === "pictures" && plain.missing && !plain.shown && plain.second === "1", plain);
rmSync(folder, { recursive: true, force: true });
if (!failed) console.log(`ok page: ${JSON.stringify(drawn.whole)} whole, ${JSON.stringify(drawn.near)} near`);
process.exit(failed ? 1 : 0);
