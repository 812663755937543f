"use strict";
const run = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const canvas = byId("map"), pen = canvas.getContext("2d");
const isGround = run.kind === "ground";
const OF_THE_THEME = { drives: "accent", flies: "accent", view: "accent", wall: "ink", lands: "fail" };
let INK, SOFT, LIGHT, PAPER, LIMIT;
let now = 0, playing = false, last = 0;

// Colours follow the system's light or dark scheme.
function theme(name) {
  return getComputedStyle(document.body).getPropertyValue(`--${name}`).trim();
}

function readTheme() {
  [INK, SOFT, LIGHT, PAPER, LIMIT] = ["ink", "soft", "line", "paper", "fail"].map(theme);
  for (const [name, variable] of Object.entries(OF_THE_THEME)) run.colours[name] = theme(variable);
}

// The plane, and for a flight a second panel with altitude over time beside it.
function layout() {
  const width = canvas.parentElement.clientWidth - 20, scale = window.devicePixelRatio || 1;
  const [[left, right], [low, high]] = run.view;
  const share = isGround ? 1 : 0.5;
  const height = Math.min(620, Math.max(260, (width * share * (high - low)) / (right - left)));
  canvas.width = width * scale;
  canvas.height = height * scale;
  canvas.style.height = height + "px";
  pen.setTransform(scale, 0, 0, scale, 0, 0);
  const zoom = Math.min((width * share) / (right - left), height / (high - low));
  const shift = (width * share - zoom * (right - left)) / 2;
  const drop = (height - zoom * (high - low)) / 2;
  return {
    width, height, zoom, panel: width * share,
    x: (v) => shift + (v - left) * zoom,
    y: (v) => drop + (high - v) * zoom,
  };
}

function line(points, colour, size, dash = []) {
  if (points.length < 2) return;
  pen.beginPath();
  points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.strokeStyle = colour;
  pen.lineWidth = size;
  pen.setLineDash(dash);
  pen.lineJoin = pen.lineCap = "round";
  pen.stroke();
  pen.setLineDash([]);
}

function shape(points, fill, edge) {
  pen.beginPath();
  points.forEach(([x, y], i) => (i ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.closePath();
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = edge;
  pen.lineWidth = 1.4;
  pen.stroke();
}

function disc(x, y, radius, fill, edge) {
  pen.beginPath();
  pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  pen.strokeStyle = edge;
  pen.lineWidth = 1.2;
  pen.stroke();
}

function word(text, x, y, colour = INK, align = "center") {
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = align;
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
}

function grid(at) {
  const [[left, right], [low, high]] = run.view;
  const step = right - left > 12 ? 2 : 1;
  for (let v = Math.ceil(left / step) * step; v <= right; v += step) {
    line([[at.x(v), at.y(low)], [at.x(v), at.y(high)]], LIGHT, 1);
    word(`${v} m`, at.x(v), at.height - 3, SOFT);
  }
  for (let v = Math.ceil(low / step) * step; v <= high; v += step)
    line([[at.x(left), at.y(v)], [at.x(right), at.y(v)]], LIGHT, 1);
}

function drawView(at, x, y, heading) {
  const half = (run.camera[0] * Math.PI) / 360;
  pen.beginPath();
  pen.moveTo(at.x(x), at.y(y));
  pen.arc(at.x(x), at.y(y), run.camera[1] * at.zoom, -heading - half, -heading + half);
  pen.closePath();
  pen.fillStyle = run.colours.view + "18";
  pen.fill();
}

function drawGround(at, number) {
  const point = ([x, y]) => [at.x(x), at.y(y)];
  const things = run.colours;
  for (const [name, x, y] of run.rooms) word(name, at.x(x) + 8, at.y(y) + 16, SOFT, "left");
  for (const wall of run.walls) line(wall.map(point), things.wall, 3);
  for (const [name, corners, middle] of run.furniture) {
    shape(corners.map(point), things.furniture, things.edge);
    word(name, at.x(middle[0]), at.y(middle[1]) + 4, "#1c2430");
  }
  for (const [name, middle, radius] of run.objects) {
    disc(at.x(middle[0]), at.y(middle[1]), radius * at.zoom, things.object, INK);
    word(name, at.x(middle[0]), at.y(middle[1] - radius) + 14);
  }
  for (const [name, middle] of run.places) word(name, at.x(middle[0]), at.y(middle[1]) + 4, SOFT);
  for (let i = 1; i <= number; i++) {
    const a = run.frames[i - 1], b = run.frames[i];
    if (a[1] !== b[1] || a[2] !== b[2])
      line([point([a[1], a[2]]), point([b[1], b[2]])], run.colours[run.did[i]] || INK, 3);
  }
  for (let i = 1; i <= number; i++)
    if (/^(turns|touches)/.test(run.did[i]) && run.did[i] !== run.did[i - 1])
      disc(at.x(run.frames[i][1]), at.y(run.frames[i][2]), 4.5, run.colours[run.did[i]], PAPER);
  const [, x, y, heading, people, , contact] = run.frames[number];
  drawView(at, x, y, heading);
  people.forEach((spot, i) => {
    if (!spot) return;
    disc(at.x(spot[0]), at.y(spot[1]), 0.25 * at.zoom, run.colours.people + "99", run.colours.people);
    word(run.people[i], at.x(spot[0]), at.y(spot[1]) + 4);
  });
  const [long, wide] = run.footprint, c = Math.cos(heading), s = Math.sin(heading);
  const corner = (u, v) => point([x + u * long * c - v * wide * s, y + u * long * s + v * wide * c]);
  const body = [corner(0.5, 0.5), corner(-0.5, 0.5), corner(-0.5, -0.5), corner(0.5, -0.5)];
  shape(body, contact ? run.colours.touches : PAPER, INK);
  line([point([x, y]), point([x + 0.45 * c, y + 0.45 * s])], INK, 2.5);
}

function drawFlight(at, number) {
  const time = run.frames[number][0], end = run.frames[run.frames.length - 1][0] || 1;
  const flown = run.track.filter((p) => p[0] <= time + 1e-6);
  line(run.planned.map((p) => [at.x(p[2]), at.y(p[1])]), SOFT, 1.2, [5, 4]);
  line(flown.map((p) => [at.x(p[2]), at.y(p[1])]), run.colours.flies, 2.5);
  const [, east, north] = run.frames[number];
  disc(at.x(east), at.y(north), 7, PAPER, INK);
  word("from above, north is up", at.panel / 2, 14, SOFT);
  const top = 1.12 * Math.max(run.highest, run.limit || 0);
  const left = at.panel + 50, right = at.width - 12, low = at.height - 22;
  const x = (t) => left + ((right - left) * t) / end, y = (v) => low - ((low - 24) * v) / top;
  for (let v = 0; v <= top; v += 2) {
    line([[left, y(v)], [right, y(v)]], LIGHT, 1);
    word(`${v} m`, left - 6, y(v) + 4, SOFT, "right");
  }
  word("altitude over time", (left + right) / 2, 14, SOFT);
  line(run.planned.map((p) => [x(p[0]), y(p[3])]), SOFT, 1.2, [5, 4]);
  line(flown.map((p) => [x(p[0]), y(p[3])]), run.colours.flies, 2.5);
  if (run.limit != null) {
    line([[left, y(run.limit)], [right, y(run.limit)]], LIMIT, 1.4);
    word(`limit of the rules: ${run.limit} m`, right, y(run.limit) - 5, LIMIT, "right");
  }
}

function show() {
  const at = layout();
  pen.clearRect(0, 0, at.width, at.height);
  const number = Math.min(run.frames.length - 1, Math.round(now / run.dt));
  const frame = run.frames[number];
  grid(at);
  (isGround ? drawGround : drawFlight)(at, number);
  const [call, planLine, shield] = run.states[number];
  byId("clock").textContent = `${frame[0].toFixed(1)} s`;
  byId("time").value = number;
  byId("call").textContent = call + (planLine ? `  (line ${planLine})` : "");
  byId("did").textContent = run.did[number] || "is at rest";
  if (isGround) byId("seen").textContent = frame[5].join(", ") || "nothing";
  byId("shield").textContent = shield || "–";
  byId("measured").textContent = isGround
    ? `${frame[7].toFixed(2)} m/s`
    : `${frame[3].toFixed(2)} m high, ${frame[4].toFixed(2)} m/s`;
}

function tick() {
  if (!playing) return;
  const end = run.frames[run.frames.length - 1][0], stamp = performance.now();
  now = Math.min(end, now + ((stamp - last) / 1000) * Number(byId("speed").value));
  last = stamp;
  show();
  if (now >= end) return toggle();
  setTimeout(tick, 30);
}

function toggle() {
  playing = !playing;
  byId("play").textContent = playing ? "Pause" : "Play";
  if (!playing) return;
  if (now >= run.frames[run.frames.length - 1][0]) now = 0;
  last = performance.now();
  tick();
}

if (!isGround) byId("seen").parentElement.remove();
byId("time").max = run.frames.length - 1;
byId("time").oninput = (event) => { now = Number(event.target.value) * run.dt; show(); };
byId("play").onclick = toggle;
window.onresize = show;
matchMedia("(prefers-color-scheme: dark)").onchange = () => { readTheme(); show(); };
readTheme();
if (isGround)
  for (const what of new Set(run.did.filter((d) => d && d !== "stands"))) {
    const entry = document.createElement("span");
    const mark = document.createElement("i");
    mark.style.background = run.colours[what];
    entry.append(mark, what);
    byId("legend").append(entry);
  }
show();
