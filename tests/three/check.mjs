// Whether a viewer shows what `umbrage ambient` writes: three.js in headless Chromium loads a GLB with an
// occlusion texture and draws it under ambient light alone; each vertex must be as bright as it is open.
// Under direct light alone nothing may change.
//
//   node tests/three/check.mjs target/debug/umbrage
//
// Needs npm with a registry (or THREE, a folder that holds three), and Chromium (or CHROMIUM, its path). Says
// so where it cannot run, and then exits with 0; with REQUIRE_THREE=1 it fails.

import { execFileSync, spawn } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import { dirname, extname, join, normalize } from "node:path";
import { fileURLToPath } from "node:url";

const VERSION = "0.180.0";
const here = dirname(fileURLToPath(import.meta.url));
const umbrage = process.argv[2];
if (!umbrage) throw new Error("name the command: node tests/three/check.mjs target/debug/umbrage");
const folder = mkdtempSync(join(tmpdir(), "umbrage-three-"));

function skip(why) {
  rmSync(folder, { recursive: true, force: true });
  console.log(`SKIPPED three.js: ${why}`);
  process.exit(process.env.REQUIRE_THREE === "1" ? 1 : 0);
}

const chromium =
  process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
if (!chromium || !existsSync(chromium)) skip("no Chromium; set CHROMIUM to its path");
let three = process.env.THREE;
if (!three) {
  try {
    execFileSync("npm", ["install", "--prefix", folder, `three@${VERSION}`], { stdio: "pipe", timeout: 120_000 });
  } catch (error) {
    skip(`npm cannot install three@${VERSION}: ${String(error.message).split("\n")[0]}`);
  }
  three = join(folder, "node_modules", "three");
}

// A floor of 8 × 8 squares, and a roof over half of it: every vertex is open by another part.
const grid = [...Array(81).keys()].map((i) => [(i % 9) - 4, Math.floor(i / 9) - 4, 0]);
const squares = [...Array(64).keys()].map((i) => 9 * Math.floor(i / 8) + (i % 8));
const meshes = [
  ["floor", grid, squares.flatMap((a) => [a, a + 1, a + 10, a, a + 10, a + 9])],
  ["roof", [[0, -4, 1], [4, -4, 1], [4, 4, 1], [0, 4, 1]], [0, 1, 2, 0, 2, 3]],
];
const document = { asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [0, 1] }], nodes: [], meshes: [] };
Object.assign(document, { materials: [], accessors: [], bufferViews: [], buffers: [] });
document.materials.push({ pbrMetallicRoughness: { metallicFactor: 0, roughnessFactor: 1 } });
let bytes = Buffer.alloc(0);
function accessor(data, componentType, type, count, bounds) {
  document.bufferViews.push({ buffer: 0, byteOffset: bytes.length, byteLength: data.byteLength });
  document.accessors.push({ bufferView: document.bufferViews.length - 1, componentType, type, count, ...bounds });
  bytes = Buffer.concat([bytes, Buffer.from(data.buffer)]);
  return document.accessors.length - 1;
}
for (const [name, corners, indices] of meshes) {
  const bound = (pick) => [0, 1, 2].map((axis) => pick(...corners.map((corner) => corner[axis])));
  const bounds = { min: bound(Math.min), max: bound(Math.max) };
  const POSITION = accessor(new Float32Array(corners.flat()), 5126, "VEC3", corners.length, bounds);
  const primitive = { attributes: { POSITION }, indices: accessor(new Uint32Array(indices), 5125, "SCALAR", indices.length) };
  document.nodes.push({ name, mesh: document.meshes.length });
  document.meshes.push({ name, primitives: [{ ...primitive, material: 0 }] });
}
document.buffers.push({ byteLength: bytes.length, uri: `data:application/octet-stream;base64,${bytes.toString("base64")}` });
const model = join(folder, "hall.gltf");
writeFileSync(model, JSON.stringify(document));
for (const form of ["texture", "attribute"]) {
  const output = join(folder, `${form}.glb`);
  execFileSync(umbrage, ["ambient", model, "-o", output, "--as", form, "--rays", "256"], { stdio: "pipe" });
}

const types = { ".html": "text/html", ".js": "text/javascript", ".glb": "model/gltf-binary" };
const server = createServer((request, response) => {
  const path = normalize(new URL(request.url, "http://localhost").pathname);
  if (request.method === "POST") {
    let text = "";
    request.on("data", (part) => (text += part));
    request.on("end", () => {
      response.end();
      judge(JSON.parse(text));
    });
    return;
  }
  const file = path.startsWith("/three/") ? join(three, path.slice(6)) : join(path === "/page.html" ? here : folder, path);
  try {
    const content = readFileSync(file);
    response.writeHead(200, { "content-type": types[extname(file)] ?? "application/octet-stream" });
    response.end(content);
  } catch {
    response.writeHead(404).end();
  }
});

let browser;
const late = setTimeout(() => finish(1, "no answer from the browser within two minutes"), 120_000);
function finish(code, text) {
  clearTimeout(late);
  console.log(text);
  process.exitCode = code;
  browser?.kill("SIGKILL");
  server.close();
  server.closeAllConnections();
  setTimeout(() => {
    rmSync(folder, { recursive: true, force: true });
    process.exit(code);
  }, 500);
}

// What the page found: of each vertex its openness, and its brightness under each light, from 0 to 1.
function judge({ error, skipped, vertices }) {
  if (skipped) return process.env.REQUIRE_THREE === "1" ? finish(1, skipped) : finish(0, `SKIPPED three.js: ${skipped}`);
  if (error) return finish(1, `FAILED three.js: ${error}`);
  // A step of eight bits in the picture, half of one for the blend of two texels.
  const most = 1.5 / 255;
  const worst = (of) => Math.max(...vertices.map(of));
  const ambient = worst((v) => Math.abs(v.ambient - v.open));
  const direct = worst((v) => v.direct) - Math.min(...vertices.map((v) => v.direct));
  const range = worst((v) => v.open) - Math.min(...vertices.map((v) => v.open));
  const said = `${vertices.length} vertices, openness over ${range.toFixed(3)}; off by ${ambient.toFixed(4)} at most under ambient light, and by ${direct.toFixed(4)} among each other under direct light`;
  // The comparison can fail: the values of another vertex would be far off.
  const shifted = worst((v) => Math.abs(v.ambient - vertices[(vertices.indexOf(v) + 1) % vertices.length].open));
  const sound = vertices.length === 49 && range > 0.3 && ambient <= most && direct <= most && shifted > 10 * most;
  finish(sound ? 0 : 1, `${sound ? "ok" : "FAILED"} three.js ${VERSION}: ${said}`);
}

server.listen(0, "127.0.0.1", () => {
  const flags = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"];
  flags.push(`--user-data-dir=${join(folder, "profile")}`, "--no-first-run", "--disable-extensions");
  browser = spawn(chromium, [...flags, `http://127.0.0.1:${server.address().port}/page.html`], { stdio: "ignore" });
  browser.on("error", (error) => finish(1, `FAILED three.js: ${error.message}`));
});
