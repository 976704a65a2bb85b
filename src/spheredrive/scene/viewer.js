"use strict";
// Draws the scene of scene.html.j2 with WebGL: bodies as they are given, poses between the samples of the track.
(() => {
  const data = JSON.parse(document.getElementById("scene").textContent);
  const find = (id) => document.getElementById(id);
  const canvas = document.querySelector("canvas");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
  if (!gl) {
    find("view").innerHTML = '<p class="note">This browser does not draw in three dimensions (WebGL is off).</p>';
    return;
  }

  // ---- numbers as they are packed: base64 of little-endian arrays
  const bytes = (text) => Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(bytes(text));

  // ---- vectors and matrices (column by column, 4x4)
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const length = (a) => Math.hypot(a[0], a[1], a[2]);
  const scaled = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
  const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
  const unit = (a) => scaled(a, 1 / (length(a) || 1));
  const frame = (x, y, z, p) => [x[0], x[1], x[2], 0, y[0], y[1], y[2], 0, z[0], z[1], z[2], 0, p[0], p[1], p[2], 1];
  const times = (a, b) => {
    const out = new Array(16);
    for (let c = 0; c < 4; c++)
      for (let r = 0; r < 4; r++)
        out[4 * c + r] = a[r] * b[4 * c] + a[4 + r] * b[4 * c + 1] + a[8 + r] * b[4 * c + 2] + a[12 + r] * b[4 * c + 3];
    return out;
  };
  const turnZ = (angle) => {
    const c = Math.cos(angle), s = Math.sin(angle);
    return frame([c, s, 0], [-s, c, 0], [0, 0, 1], [0, 0, 0]);
  };
  const ofQuaternion = ([w, x, y, z], p) =>
    frame(
      [1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
      [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
      [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)],
      p,
    );
  // A body along z, made to reach from one point along a vector; its width goes with `width`.
  const pointing = (from, vector, width) => {
    const z = unit(vector);
    const x = unit(cross(Math.abs(z[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], z));
    return frame(scaled(x, width), scaled(cross(z, x), width), vector, from);
  };

  // ---- drawing
  const program = gl.createProgram();
  const shader = (kind, text) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    gl.attachShader(program, made);
  };
  shader(gl.VERTEX_SHADER, `attribute vec3 place, normal; uniform mat4 model, view; varying vec3 facing;
    void main() { facing = mat3(model) * normal; gl_Position = view * model * vec4(place, 1.0); }`);
  shader(gl.FRAGMENT_SHADER, `precision mediump float; uniform vec3 colour, light; uniform float flat_, solid; varying vec3 facing;
    void main() { vec3 n = normalize(facing); float lit = 0.62 + 0.38 * max(dot(n, light), 0.0) - 0.14 * max(-n.z, 0.0);
      gl_FragColor = vec4(colour * mix(lit, 1.0, flat_), solid); }`);
  gl.linkProgram(program);
  gl.useProgram(program);
  const uniform = (name) => gl.getUniformLocation(program, name);
  const [uModel, uView, uColour, uLight, uFlat, uSolid] = ["model", "view", "colour", "light", "flat_", "solid"].map(uniform);
  const aPlace = gl.getAttribLocation(program, "place"), aNormal = gl.getAttribLocation(program, "normal");
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(1, 1, 1, 1);
  gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  const wide = gl.getExtension("OES_element_index_uint");

  const normalsOf = (v, f) => {
    const n = new Float32Array(v.length);
    for (let i = 0; i < f.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => [v[3 * f[i + k]], v[3 * f[i + k] + 1], v[3 * f[i + k] + 2]]);
      const m = cross(plus(b, scaled(a, -1)), plus(c, scaled(a, -1)));
      for (let k = 0; k < 3; k++) for (let d = 0; d < 3; d++) n[3 * f[i + k] + d] += m[d];
    }
    return n;
  };
  const buffer = (kind, content) => {
    const made = gl.createBuffer();
    gl.bindBuffer(kind, made);
    gl.bufferData(kind, content, gl.STATIC_DRAW);
    return made;
  };
  const body = (v, n, f) => ({
    v: buffer(gl.ARRAY_BUFFER, v),
    n: buffer(gl.ARRAY_BUFFER, n),
    f: buffer(gl.ELEMENT_ARRAY_BUFFER, wide ? new Uint32Array(f) : new Uint16Array(f)),
    count: f.length,
  });
  const meshes = data.meshes.map((m) => {
    const v = Float32Array.from(new Int16Array(bytes(m.v)), (x) => x * m.scale);
    const f = Array.from(new Uint16Array(bytes(m.f)));
    return { v, f, n: normalsOf(v, f) };
  });
  // All rollers of a race as one body.
  const gathered = (mesh, places, turns) => {
    const count = places.length / 3, k = mesh.v.length;
    const v = new Float32Array(k * count), n = new Float32Array(k * count), f = [];
    for (let j = 0; j < count; j++) {
      const t = turns.subarray(9 * j, 9 * j + 9), p = places.subarray(3 * j, 3 * j + 3);
      for (let i = 0; i < k; i += 3)
        for (let d = 0; d < 3; d++) {
          const row = (w) => t[3 * d] * w[i] + t[3 * d + 1] * w[i + 1] + t[3 * d + 2] * w[i + 2];
          v[j * k + i + d] = row(mesh.v) + p[d];
          n[j * k + i + d] = row(mesh.n);
        }
      for (const index of mesh.f) f.push(index + (j * k) / 3);
    }
    return body(v, n, f);
  };
  const whole = (i) => body(meshes[i].v, meshes[i].n, meshes[i].f);
  const draw = (what, model, colour, flat = 0) => {
    gl.uniformMatrix4fv(uModel, false, model);
    gl.uniform3fv(uColour, colour);
    gl.uniform1f(uFlat, flat);
    for (const [at, from] of [[aPlace, what.v], [aNormal, what.n]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, from);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, 3, gl.FLOAT, false, 0, 0);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, what.f);
    gl.drawElements(gl.TRIANGLES, what.count, wide ? gl.UNSIGNED_INT : gl.UNSIGNED_SHORT, 0);
  };

  // ---- the bodies
  const still = frame([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]);
  const R = data.radius;
  const sphere = data.sphere.map((part) => ({ body: whole(part.mesh), colour: part.colour }));
  const cage = whole(data.cage), dot = whole(data.dot), arrow = whole(data.arrow);
  const wheels = data.wheels.map((w) => ({
    ...w,
    hub: whole(w.hub),
    races: w.races.map((race) => gathered(meshes[race.mesh], floats(race.places), floats(race.turns))),
    stand: frame(w.x, w.y, w.z, w.centre),
  }));

  // ---- the track
  const t = data.track, k = t.count, n = data.wheel_count, m = data.contacts.length;
  const time = floats(t.time), angle = floats(t.angle), speed = floats(t.speed), Omega = floats(t.omega);
  const turns = new Int16Array(bytes(t.orientation)), touching = new Uint8Array(bytes(t.touching));
  const shift = t.displacement ? floats(t.displacement) : null, stage = t.stage ? floats(t.stage) : null;
  const quaternion = (i) => [0, 1, 2, 3].map((d) => turns[4 * i + d] / 32767);
  const fastest = Math.max(...Array.from(speed, Math.abs), 1e-9);
  let quickest = 1e-9;
  for (let i = 0; i < k; i++) quickest = Math.max(quickest, length(Omega.subarray(3 * i, 3 * i + 3)));

  let now = time[0], playing = k > 1 && !matchMedia("(prefers-reduced-motion: reduce)").matches, gain = data.gain;
  const sampleAt = (at) => {
    let low = 0, high = k - 1;
    while (high - low > 1) {
      const mid = (low + high) >> 1;
      if (time[mid] <= at) low = mid;
      else high = mid;
    }
    if (k > 1 && at >= time[k - 1]) low = k - 2;
    return low;
  };
  const pose = (at) => {
    const i = sampleAt(at), j = Math.min(i + 1, k - 1);
    const s = j > i ? Math.min(Math.max((at - time[i]) / (time[j] - time[i]), 0), 1) : 0;
    const mix = (from, width) => Array.from({ length: width }, (_, d) => (1 - s) * from[i * width + d] + s * from[j * width + d]);
    const a = quaternion(i), b = quaternion(j);
    const sign = a.reduce((sum, x, d) => sum + x * b[d], 0) < 0 ? -1 : 1;
    const q = a.map((x, d) => (1 - s) * x + s * sign * b[d]);
    const norm = Math.hypot(...q);
    return {
      sample: s < 1 ? i : j,
      q: q.map((x) => x / norm),
      angle: mix(angle, n),
      speed: mix(speed, n),
      omega: mix(Omega, 3),
      shift: shift ? mix(shift, 3) : [0, 0, 0],
      stage: stage ? mix(stage, 3) : [0, 0, 0],
    };
  };

  // ---- the camera: turns about the sphere's centre, z up
  const camera = { azimuth: -1.0, elevation: data.elevation, distance: 1.0 };
  const viewMatrix = () => {
    const w = canvas.clientWidth, h = canvas.clientHeight, aspect = w / h;
    const half = Math.tan(0.26), near = 0.02 * data.reach, far = 40 * data.reach;
    const distance = (1.12 * data.reach * camera.distance) / Math.sin(0.26) / Math.min(1, aspect);
    const c = Math.cos(camera.elevation);
    const back = [c * Math.cos(camera.azimuth), c * Math.sin(camera.azimuth), Math.sin(camera.elevation)];
    const right = unit(cross([0, 0, 1], back)), up = cross(back, right);
    gl.uniform3fv(uLight, unit(plus(plus(scaled(up, 0.9), scaled(right, -0.5)), back)));
    // The camera looks at the middle of the machine, which stands data.aim above the sphere's centre.
    const low = [right[2], up[2], back[2]].map((x) => -x * data.aim);
    const look = [right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, low[0], low[1], low[2] - distance, 1];
    const lens = [1 / (half * aspect), 0, 0, 0, 0, 1 / half, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
    return times(lens, look);
  };

  const paint = () => {
    const ratio = Math.min(devicePixelRatio || 1, 2);
    const w = Math.max(1, Math.round(canvas.clientWidth * ratio)), h = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
    gl.viewport(0, 0, w, h);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(uView, false, viewMatrix());
    const p = pose(now);
    const off = scaled(p.shift, gain);
    const turned = ofQuaternion(p.q, off);
    gl.uniform1f(uSolid, 1);
    if (!find("glass").checked) for (const part of sphere) draw(part.body, turned, part.colour);
    draw(dot, times(turned, frame([1.6 * data.spot, 0, 0], [0, 1.6 * data.spot, 0], [0, 0, 1.6 * data.spot], [R, 0, 0])), data.colours.mark);
    draw(cage, still, data.colours.stage);
    for (const wheel of wheels) {
      const model = times(wheel.stand, turnZ(p.angle[wheel.wheel]));
      draw(wheel.hub, model, wheel.colour);
      for (const race of wheel.races) draw(race, model, data.colours.rubber);
      const share = p.speed[wheel.wheel] / fastest;
      if (Math.abs(share) > 1e-3) {
        const vector = scaled(wheel.z, Math.sign(share) * (1.3 * wheel.wide + 1.6 * wheel.radius * Math.abs(share)));
        draw(arrow, pointing(wheel.centre, vector, 1.6 * wheel.radius), wheel.colour);
      }
    }
    data.contacts.forEach((contact, i) => {
      const on = touching[p.sample * m + i];
      const size = data.spot * (on ? 1 : 0.55);
      draw(dot, frame([size, 0, 0], [0, size, 0], [0, 0, size], contact.place), on ? data.colours.contact : data.colours.light, 1);
    });
    for (const drive of data.drives) draw(arrow, pointing(drive.from, drive.vector, 0.7 * length(drive.vector)), drive.colour);
    const turn = length(p.omega) / quickest;
    if (turn > 1e-3) {
      const u = unit(p.omega), long = R * (0.12 + 0.55 * turn);
      draw(arrow, pointing(plus(off, scaled(u, R)), scaled(u, long), 0.6 * R), data.colours.ink);
    }
    drawTrail(p.sample, off);
    if (find("glass").checked) {
      gl.uniform1f(uSolid, 0.45);
      gl.enable(gl.BLEND);
      gl.enable(gl.CULL_FACE);
      for (const part of sphere) draw(part.body, turned, part.colour);
      gl.disable(gl.CULL_FACE);
      gl.disable(gl.BLEND);
    }
    show(p);
  };

  // ---- the path of the sphere's mark
  const trailBuffer = gl.createBuffer(), trail = new Float32Array(3 * k);
  for (let i = 0; i < k; i++) {
    const [qw, x, y, z] = quaternion(i);
    trail.set([1 - 2 * (y * y + z * z), 2 * (x * y + qw * z), 2 * (x * z - qw * y)].map((c) => 1.008 * R * c), 3 * i);
  }
  gl.bindBuffer(gl.ARRAY_BUFFER, trailBuffer);
  gl.bufferData(gl.ARRAY_BUFFER, trail, gl.STATIC_DRAW);
  const drawTrail = (sample, off) => {
    if (sample < 1) return;
    gl.uniformMatrix4fv(uModel, false, frame([1, 0, 0], [0, 1, 0], [0, 0, 1], off));
    gl.uniform3fv(uColour, data.colours.mark);
    gl.uniform1f(uFlat, 1);
    gl.bindBuffer(gl.ARRAY_BUFFER, trailBuffer);
    gl.vertexAttribPointer(aPlace, 3, gl.FLOAT, false, 0, 0);
    gl.disableVertexAttribArray(aNormal);
    gl.vertexAttrib3f(aNormal, 0, 0, 1);
    gl.drawArrays(gl.LINE_STRIP, 0, sample + 1);
  };

  // ---- words and controls
  const fixed = (x, digits) => (Math.abs(x) < 0.5 * 10 ** -digits ? 0 : x).toFixed(digits).replace("-", "\u2212");
  const digits = Math.max(0, Math.min(4, 2 - Math.floor(Math.log10(Math.max(time[k - 1], 1e-3) / 5))));
  const show = (p) => {
    const speeds = n <= 8 ? `\nω  ${p.speed.map((x) => fixed(x, 2)).join("  ")} rad/s` : "";
    const carried = stage ? `\nstage at  ${p.stage.map((x) => fixed(x, 3)).join("  ")} m` : "";
    find("values").textContent = `Ω  ${p.omega.map((x) => fixed(x, 3)).join("  ")} rad/s${speeds}${carried}`;
    find("clock").textContent = `${fixed(now, digits)} of ${fixed(time[k - 1], digits)} s`;
    if (document.activeElement !== find("time") || playing)
      find("time").value = Math.round((1000 * (now - time[0])) / (time[k - 1] - time[0] || 1));
    find("play").textContent = playing ? "Pause" : "Play";
  };
  let asked = false, before = 0;
  const again = () => {
    if (!asked) {
      asked = true;
      requestAnimationFrame(tick);
    }
  };
  const tick = (at) => {
    asked = false;
    if (playing) {
      const passed = before ? Math.min((at - before) / 1000, 0.1) : 0;
      now += passed * Number(find("speed").value);
      if (now > time[k - 1]) now = time[0];
    }
    before = playing ? at : 0;
    paint();
    if (playing) again();
  };
  if (k < 2) for (const one of document.querySelectorAll("#bar .moving")) one.hidden = true;
  else {
    const step = (by) => {
      playing = false;
      now = time[Math.min(Math.max(sampleAt(now + 1e-9 * time[k - 1]) + (now >= time[k - 1] ? 1 : 0) + by, 0), k - 1)];
      again();
    };
    find("back").onclick = () => step(-1);
    find("on").onclick = () => step(1);
    find("play").onclick = () => {
      playing = !playing;
      again();
    };
    find("time").oninput = (event) => {
      playing = false;
      now = time[0] + (event.target.value / 1000) * (time[k - 1] - time[0]);
      again();
    };
  }
  find("glass").onchange = again;
  if (shift) {
    find("shake").hidden = false;
    for (const factor of data.gains) find("gain").add(new Option(`× ${factor}`, factor, false, factor === gain));
    find("gain").onchange = (event) => {
      gain = Number(event.target.value);
      again();
    };
  }
  const turnBy = (x, y) => {
    camera.azimuth -= x;
    camera.elevation = Math.min(Math.max(camera.elevation + y, -1.55), 1.55);
    again();
  };
  let held = null;
  canvas.onpointerdown = (event) => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  };
  canvas.onpointermove = (event) => {
    if (!held) return;
    turnBy(0.008 * (event.clientX - held[0]), 0.008 * (event.clientY - held[1]));
    held = [event.clientX, event.clientY];
  };
  canvas.onpointerup = canvas.onpointercancel = () => (held = null);
  canvas.addEventListener("wheel", (event) => {
    if (document.activeElement !== canvas && window.parent !== window) return;
    event.preventDefault();
    camera.distance = Math.min(Math.max(camera.distance * Math.exp(0.001 * event.deltaY), 0.15), 6);
    again();
  }, { passive: false });
  canvas.onkeydown = (event) => {
    const by = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[event.key];
    if (by) turnBy(...by);
    else if (event.key === "+" || event.key === "-") camera.distance *= event.key === "+" ? 0.9 : 1.1;
    else return;
    event.preventDefault();
    again();
  };
  addEventListener("resize", again);
  window.sceneState = () => ({ time: now, playing, samples: k });
  again();
})();
