"use strict";
const data = JSON.parse(document.getElementById("data").textContent);

// The view: the mesh in flat shading from both sides, defects over it, dimmed where the mesh hides them.
// Null without WebGL 2.
const view = (() => {
  const canvas = document.querySelector("canvas");
  const gl = canvas.getContext("webgl2", { antialias: true });
  if (!gl) return null;

  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  const program = (vertex, fragment) => {
    const linked = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, "#version 300 es\nprecision highp float;\n" + source);
      gl.compileShader(shader);
      gl.attachShader(linked, shader);
    }
    gl.linkProgram(linked);
    if (!gl.getProgramParameter(linked, gl.LINK_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getProgramInfoLog(linked));
    }
    const names = ["target", "turn", "lens", "color", "ink", "size", "screen", "alpha"];
    return { linked, at: Object.fromEntries(names.map((name) => [name, gl.getUniformLocation(linked, name)])) };
  };

  // From the mesh to the eye: first to the point that is looked at, so that digits are left for what is small.
  const CAMERA = `
    uniform vec3 target; uniform mat3 turn; uniform vec4 lens; // focal length along x and y, near, far
    uniform float size;
    vec3 seen(vec3 p) { return turn * (p - target) - vec3(0, 0, size); }
    vec4 clip(vec3 v) {
      float n = lens.z, f = lens.w;
      return vec4(lens.x * v.x, lens.y * v.y, ((n + f) * v.z + 2.0 * n * f) / (n - f), -v.z);
    }`;
  const surface = program(
    `${CAMERA} in vec3 position; out vec3 eye;
    void main() { eye = seen(position); gl_Position = clip(eye); }`,
    `in vec3 eye; out vec4 o; uniform vec3 color;
    void main() {
      vec3 n = normalize(cross(dFdx(eye), dFdy(eye)));
      float light = 0.45 + 0.6 * abs(dot(n, normalize(vec3(0.35, 0.5, 1.0))));
      // The side that no light should reach from: warmer and darker.
      o = vec4((gl_FrontFacing ? color : color * vec3(0.82, 0.62, 0.5)) * light, 1);
    }`,
  );
  // What lies on the mesh is drawn a little nearer to the eye, at the same place of the picture.
  const line = program(
    `${CAMERA} in vec3 a; in vec3 b; uniform vec2 screen; uniform float ink;
    void main() {
      vec3 p = seen(a) * 0.998, q = seen(b) * 0.998;
      float n = -lens.z;
      if (p.z > n && q.z > n) { gl_Position = vec4(2, 2, 2, 1); return; }
      if (p.z > n) p = mix(p, q, (p.z - n) / (p.z - q.z));
      else if (q.z > n) q = mix(q, p, (q.z - n) / (q.z - p.z));
      vec4 u = clip(p), v = clip(q);
      vec2 along = (v.xy / v.w - u.xy / u.w) * screen;
      along = length(along) > 0.0 ? normalize(along) : vec2(1, 0);
      vec4 end = gl_VertexID < 2 ? u : v;
      float side = gl_VertexID % 2 == 0 ? 1.0 : -1.0;
      vec2 step = vec2(-along.y, along.x) * side + along * (gl_VertexID < 2 ? -0.5 : 0.5);
      gl_Position = end + vec4(step * ink / screen * end.w, 0, 0);
    }`,
    `out vec4 o; uniform vec3 color; uniform float alpha; void main() { o = vec4(color, alpha); }`,
  );
  const dot = program(
    `${CAMERA} in vec3 position; uniform float ink;
    void main() { gl_Position = clip(seen(position) * 0.998); gl_PointSize = ink; }`,
    `out vec4 o; uniform vec3 color; uniform float alpha;
    void main() {
      float r = length(gl_PointCoord - 0.5) * 2.0;
      if (r > 1.0) discard;
      o = vec4(r > 0.72 ? vec3(0.12) : color, alpha);
    }`,
  );

  const buffer = (content, kind = gl.ARRAY_BUFFER) => {
    const made = gl.createBuffer();
    gl.bindBuffer(kind, made);
    gl.bufferData(kind, content, gl.STATIC_DRAW);
    return made;
  };
  const array = (fill) => {
    const made = gl.createVertexArray();
    gl.bindVertexArray(made);
    fill();
    gl.bindVertexArray(null);
    return made;
  };
  const attribute = (which, name, from, stride, offset, divisor) => {
    const at = gl.getAttribLocation(which.linked, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, from);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, 3, gl.FLOAT, false, stride, offset);
    gl.vertexAttribDivisor(at, divisor);
  };
  const positions = buffer(bytes(data.positions));
  const faces = (text) => {
    const indices = bytes(text);
    return {
      count: indices.byteLength / 4,
      array: array(() => {
        attribute(surface, "position", positions, 0, 0, 0);
        buffer(indices, gl.ELEMENT_ARRAY_BUFFER);
      }),
    };
  };
  const lines = (from, first) =>
    array(() => {
      attribute(line, "a", from, 24, 24 * first, 1);
      attribute(line, "b", from, 24, 24 * first + 12, 1);
    });
  const mesh = faces(data.indices);
  const kinds = data.kinds.map((kind) => {
    const ends = buffer(bytes(kind.lines.ends));
    const spots = buffer(bytes(kind.spots.at));
    return {
      name: kind.kind, color: kind.color.map((byte) => byte / 255), shown: true, ends,
      faces: faces(kind.faces), lines: lines(ends, 0), lineCount: kind.lines.drawn,
      spots: array(() => attribute(dot, "position", spots, 0, 0, 0)), spotCount: kind.spots.drawn,
    };
  });
  const ring = buffer(new Float32Array(3));
  const ringArray = array(() => attribute(dot, "position", ring, 0, 0, 0));

  // The eye looks to `at` from `distance` away, turned by `yaw` about the vertical and raised by `pitch`.
  const HALF = Math.PI / 2 - 0.01;
  const start = { at: [0, 0, 0], yaw: 0.54, pitch: 0.37, distance: 2.5 };
  let camera = structuredClone(start);
  let chosen = null;
  const turned = ({ yaw, pitch }) => {
    const [s, c, t, d] = [Math.sin(yaw), Math.cos(yaw), Math.sin(pitch), Math.cos(pitch)];
    return { right: [c, 0, -s], up: [-s * t, d, -c * t], back: [s * d, t, c * d] };
  };
  const dark = matchMedia("(prefers-color-scheme: dark)");

  let asked = false;
  const redraw = () => {
    if (!asked) requestAnimationFrame(draw);
    asked = true;
  };
  function draw() {
    asked = false;
    const scale = Math.min(devicePixelRatio || 1, 2);
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * scale)));
    if (canvas.width !== width || canvas.height !== height) [canvas.width, canvas.height] = [width, height];
    gl.viewport(0, 0, width, height);
    const paper = dark.matches ? [0.118, 0.129, 0.153] : [0.961, 0.965, 0.973];
    gl.clearColor(...paper, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);

    const { right, up, back } = turned(camera);
    const eye = camera.at.map((x, axis) => x + camera.distance * back[axis]);
    const depth = Math.hypot(...eye);
    const near = Math.max(camera.distance / 50, depth - 1.1);
    // The same sphere fits, whichever side of the picture is the smaller one.
    const focal = 2.4 * Math.min(1, width / height);
    const lens = [focal * (height / width), focal, near, Math.max(depth + 1.1, 2 * near)];
    const begin = (which) => {
      gl.useProgram(which.linked);
      gl.uniform3fv(which.at.target, camera.at);
      gl.uniformMatrix3fv(which.at.turn, false, [0, 1, 2].flatMap((axis) => [right[axis], up[axis], back[axis]]));
      gl.uniform4fv(which.at.lens, lens);
      gl.uniform1f(which.at.size, camera.distance);
      gl.uniform2f(which.at.screen, width / 2, height / 2);
    };
    const shown = kinds.filter((kind) => kind.shown);
    const of = chosen && shown.find((kind) => kind.name === chosen.kind);

    begin(surface);
    gl.depthFunc(gl.LESS);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    const fill = (what, color, offset) => {
      if (!what.count) return;
      gl.polygonOffset(offset, offset);
      gl.uniform3fv(surface.at.color, color);
      gl.bindVertexArray(what.array);
      gl.drawElements(gl.TRIANGLES, what.count, gl.UNSIGNED_INT, 0);
    };
    fill(mesh, [0.8, 0.81, 0.83], 2);
    for (const kind of shown) fill(kind.faces, kind.color, 1);
    gl.disable(gl.POLYGON_OFFSET_FILL);

    // Once behind the mesh, faint, and once before it.
    gl.depthMask(false);
    const ink = dark.matches ? [1, 1, 1] : [0, 0, 0];
    for (const [test, alpha] of [[gl.GREATER, 0.3], [gl.LEQUAL, 1]]) {
      gl.depthFunc(test);
      const strokes = (what, count, color, thick) => {
        if (!count) return;
        gl.uniform3fv(line.at.color, color);
        gl.uniform1f(line.at.alpha, alpha);
        gl.uniform1f(line.at.ink, thick * scale);
        gl.bindVertexArray(what);
        gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
      };
      begin(line);
      if (of && chosen.lines) strokes(chosen.lines, chosen.count, ink, 3.5);
      for (const kind of shown) strokes(kind.lines, kind.lineCount, kind.color, 1.4);
      if (of && chosen.lines) strokes(chosen.lines, chosen.count, of.color, 2);
      begin(dot);
      gl.uniform1f(dot.at.alpha, alpha);
      for (const kind of shown) {
        if (!kind.spotCount) continue;
        gl.uniform3fv(dot.at.color, kind.color);
        gl.uniform1f(dot.at.ink, 9 * scale);
        gl.bindVertexArray(kind.spots);
        gl.drawArrays(gl.POINTS, 0, kind.spotCount);
      }
      if (of && !chosen.lines) {
        gl.uniform3fv(dot.at.color, of.color);
        gl.uniform1f(dot.at.ink, 16 * scale);
        gl.bindVertexArray(ringArray);
        gl.drawArrays(gl.POINTS, 0, 1);
      }
    }
    gl.depthMask(true);
    gl.bindVertexArray(null);
    document.documentElement.dataset.drawn = String(Number(document.documentElement.dataset.drawn || 0) + 1);
  }

  // A flight of a third of a second, or none for those who ask for less motion.
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  let flight = 0;
  function fly(to) {
    const mine = ++flight;
    const from = structuredClone(camera);
    // The short way around.
    from.yaw += 2 * Math.PI * Math.round((to.yaw - from.yaw) / (2 * Math.PI));
    const [began, lasts] = [performance.now(), still.matches ? 0 : 350];
    const move = (now) => {
      if (mine !== flight) return;
      const t = lasts ? Math.min(1, Math.max(0, now - began) / lasts) : 1;
      const s = t * t * (3 - 2 * t);
      const mix = (a, b) => a + (b - a) * s;
      camera = {
        at: from.at.map((x, axis) => mix(x, to.at[axis])),
        yaw: mix(from.yaw, to.yaw),
        pitch: mix(from.pitch, to.pitch),
        distance: Math.exp(mix(Math.log(from.distance), Math.log(to.distance))),
      };
      redraw();
      if (t < 1) requestAnimationFrame(move);
    };
    if (lasts) requestAnimationFrame(move);
    else move(began);
  }
  const clamp = (x, low, high) => Math.min(high, Math.max(low, x));
  const zoom = (factor) => {
    flight++;
    camera.distance = clamp(camera.distance * factor, 1e-5, 30);
    redraw();
  };

  // One pointer turns, with Shift or another button it moves; two move and zoom.
  const pointers = new Map();
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    flight++;
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const spread = () => {
      const [a, b] = [...pointers.values()];
      return Math.hypot(a[0] - b[0], a[1] - b[1]) || 1;
    };
    const width = pointers.size === 2 ? spread() : 1;
    const [dx, dy] = [event.clientX - before[0], event.clientY - before[1]];
    pointers.set(event.pointerId, [event.clientX, event.clientY]);
    if (pointers.size === 2) camera.distance = clamp((camera.distance * width) / spread(), 1e-5, 30);
    if (pointers.size === 2 || event.shiftKey || event.buttons & 6) {
      const { right, up } = turned(camera);
      const step = (0.9 * camera.distance) / canvas.clientHeight / pointers.size;
      camera.at = camera.at.map((x, axis) => clamp(x - step * (dx * right[axis] - dy * up[axis]), -2, 2));
    } else {
      camera.yaw -= dx * 0.008;
      camera.pitch = clamp(camera.pitch + dy * 0.008, -HALF, HALF);
    }
    redraw();
  });
  for (const end of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(clamp(event.deltaY * (event.deltaMode ? 16 : 1), -240, 240) * 0.0015));
  }, { passive: false });
  addEventListener("resize", redraw);
  dark.addEventListener("change", redraw);

  return {
    canvas,
    draw,
    redraw,
    reset() {
      chosen = null;
      fly(start);
    },
    show(name, shown) {
      for (const kind of kinds) if (kind.name === name) kind.shown = shown;
      redraw();
    },
    // Marks a defect and looks at it from the side that its faces look to.
    choose({ kind, view: { at, reach, normal, lines: [first, count] } }) {
      const of = kinds.find((one) => one.name === kind);
      if (chosen?.lines) gl.deleteVertexArray(chosen.lines);
      chosen = { kind, count, lines: count ? lines(of.ends, first) : null };
      gl.bindBuffer(gl.ARRAY_BUFFER, ring);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(at), gl.STATIC_DRAW);
      const to = { at, yaw: camera.yaw, pitch: camera.pitch, distance: clamp(reach * 3.2, 1e-4, 2.5) };
      const { back } = turned(camera);
      if (normal && normal[0] * back[0] + normal[1] * back[1] + normal[2] * back[2] < 0.5) {
        // Not along the normal, which would show a hole without its depth.
        to.yaw = Math.atan2(normal[0], normal[2]) + 0.35;
        to.pitch = clamp(Math.asin(clamp(normal[1], -1, 1)) + 0.25, -1.3, 1.3);
      }
      fly(to);
    },
  };
})();
