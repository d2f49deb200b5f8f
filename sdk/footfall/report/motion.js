"use strict";
// Plays the motion on a canvas. What it draws are the page's own paths and numbers.
const motion = JSON.parse(document.getElementById("motion").textContent);

const REST = [0, 0, 0];

// A row of numbers at a time, between its frames on a straight line.
function between(rows, [k, share]) {
  const a = rows[k], b = rows[Math.min(k + 1, rows.length - 1)];
  return a.map((value, i) => value + share * (b[i] - value));
}

function pose(clip, body, where) {
  const rows = clip.poses[body];
  return rows ? between(rows, where) : REST;
}

function world([x, y, angle], [across, up]) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return [x + c * across - s * up, y + s * across + c * up];
}

// The frame before a time, and how far it is on the way to the next one.
function locate(time, t) {
  let low = 0, high = time.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (time[middle] <= t) low = middle; else high = middle - 1;
  }
  const next = Math.min(low + 1, time.length - 1), width = time[next] - time[low];
  return [low, width > 0 ? Math.min(1, Math.max(0, (t - time[low]) / width)) : 0];
}

function zigzag(start, end, breadth) {
  const along = [end[0] - start[0], end[1] - start[1]], length = Math.hypot(...along) || 1;
  const across = [-along[1] / length * breadth, along[0] / length * breadth];
  const path = new Path2D();
  path.moveTo(...start);
  for (let i = 0; i < 12; i++) {
    const share = 0.15 + 0.7 * i / 11, side = i === 0 || i === 11 ? 0 : i % 2 ? 1 : -1;
    path.lineTo(start[0] + share * along[0] + side * across[0], start[1] + share * along[1] + side * across[1]);
  }
  path.lineTo(...end);
  return path;
}

function polyline(points) {
  const path = new Path2D();
  points.forEach((point, i) => (i ? path.lineTo(...point) : path.moveTo(...point)));
  return path;
}

class Stage {
  constructor(canvas) {
    this.canvas = canvas;
    this.pen = canvas.getContext("2d");
    this.clips = motion.clips.map((clip) => ({
      ...clip,
      pieces: clip.pieces.map(([body, kind, style, path]) => ({ body, kind, style, path: new Path2D(path) })),
      ways: clip.traces.map(([style, rows]) => ({ style, path: polyline(rows) })),
    }));
    new ResizeObserver(() => this.fit()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.fit());
    this.t = this.clips[0].time[0];
    this.fit();
  }

  clip(t) {
    return this.clips.find((clip) => t <= clip.time[clip.time.length - 1]) ?? this.clips[this.clips.length - 1];
  }

  fit() {
    const [across, up] = this.canvas.dataset.shape.split(" / ").map(Number);
    const width = this.canvas.clientWidth, dense = devicePixelRatio || 1;
    if (!width) return;
    const height = Math.round(width * up / across);
    this.canvas.style.setProperty("height", `${height}px`);
    this.canvas.width = Math.round(width * dense);
    this.canvas.height = Math.round(height * dense);
    const style = getComputedStyle(this.canvas);
    this.colour = (name) => style.getPropertyValue(`--${name}`).trim();
    this.dense = dense;
    this.draw(this.t);
  }

  // From the world to the canvas: x right, y up, one scale for both.
  camera(clip, where) {
    let [left, low, right, high] = motion.view;
    if (motion.follow) {
      const middles = clip.traces.map(([, rows]) => between(rows, where));
      const mean = (i) => middles.reduce((sum, point) => sum + point[i], 0) / Math.max(1, middles.length);
      const half = motion.follow / 2, tall = half * this.canvas.height / this.canvas.width;
      const [x, y] = [mean(0), mean(1)];
      [left, right, low, high] = [x - half, x + half, y - tall, y + tall];
    }
    this.seen = [left, low, right, high];
    const scale = this.canvas.width / (right - left);
    return new DOMMatrix([scale, 0, 0, -scale, -left * scale, high * scale]);
  }

  draw(t) {
    this.t = t;
    const { pen, canvas } = this, clip = this.clip(t), where = locate(clip.time, t);
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, canvas.width, canvas.height);
    pen.lineJoin = pen.lineCap = "round";
    this.eye = this.camera(clip, where);
    clip.surfaces.forEach((line) => this.surface(line));
    this.clips.forEach((one) => one.ways.forEach((way) => this.stroke(way.path, this.style(way.style), 1, 0.45)));
    clip.pieces.forEach((piece) => this.piece(piece, pose(clip, piece.body, where)));
    clip.sticks.forEach(([style, rows]) => {
      const [x1, y1, x2, y2] = between(rows, where), path = polyline([[x1, y1], [x2, y2]]);
      this.stroke(path, this.style(style), 7);
      this.stroke(path, this.colour("paper"), 4);
      this.stroke(path, this.style(style), 4, 0.28);
    });
    clip.springs.forEach((ends) => {
      const [start, end] = ends.map(([body, at]) => world(pose(clip, body, where), at));
      this.stroke(zigzag(start, end, 0.06 * motion.size), this.colour("soft"), 1.6);
    });
    clip.forces.forEach((rows) => this.arrow(rows[where[1] < 0.5 ? where[0] : Math.min(where[0] + 1, rows.length - 1)]));
  }

  style(name) {
    return name ? this.colour(`c${name.slice(1)}`) : this.colour("soft");
  }

  // A path in the world's metres, stroked with a pen of a screen's pixels.
  seenPath(path, matrix = this.eye) {
    const made = new Path2D();
    made.addPath(path, matrix);
    return made;
  }

  stroke(path, colour, width, alpha = 1, matrix = this.eye) {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.strokeStyle = colour;
    pen.lineWidth = width * this.dense;
    pen.stroke(this.seenPath(path, matrix));
    pen.globalAlpha = 1;
  }

  fill(path, colour, alpha, matrix = this.eye) {
    const { pen } = this;
    pen.globalAlpha = alpha;
    pen.fillStyle = colour;
    pen.fill(this.seenPath(path, matrix));
    pen.globalAlpha = 1;
  }

  piece({ kind, style, path }, [x, y, angle]) {
    const c = Math.cos(angle), s = Math.sin(angle);
    const matrix = this.eye.multiply(new DOMMatrix([c, s, -s, c, x, y]));
    const paper = this.colour("paper"), ink = this.colour("ink");
    if (kind === "rail") return this.stroke(path, this.colour("line"), 2, 1, matrix);
    if (kind === "ink") return this.fill(path, ink, 1, matrix);
    if (kind === "body") {
      this.fill(path, paper, 1, matrix);
      this.fill(path, this.style(style), 0.28, matrix);
      return this.stroke(path, this.style(style), 1.6, 1, matrix);
    }
    this.fill(path, paper, 1, matrix);
    this.stroke(path, ink, 1.3, 1, matrix);
  }

  surface(line) {
    const [left, low, right] = this.seen, first = line[0], last = line[line.length - 1];
    const ends = [[Math.min(left, first[0]), first[1]], ...line, [Math.max(right, last[0]), last[1]]];
    const foot = Math.min(low, ...line.map((point) => point[1])) - motion.size;
    this.fill(polyline([...ends, [ends[ends.length - 1][0], foot], [ends[0][0], foot]]), this.colour("line"), 0.3);
    this.stroke(polyline(ends), this.colour("soft"), 1.6);
  }

  arrow([x, y, fx, fy]) {
    if (fx === null || fy === null) return;
    const force = Math.hypot(fx, fy), size = force * motion.newton;
    if (size < 0.02 * motion.size) return;
    const tip = [x + fx * motion.newton, y + fy * motion.newton];
    const head = Math.min(0.1 * motion.size, 0.5 * size) / force;
    const ends = [0.4, -0.4].map((side) => [tip[0] - head * (fx + side * fy), tip[1] - head * (fy - side * fx)]);
    this.stroke(polyline([[x, y], tip]), this.colour("bad"), 2);
    this.stroke(polyline([ends[0], tip, ends[1]]), this.colour("bad"), 2);
  }
}

class Player {
  constructor(figure) {
    figure.hidden = false;
    const find = (name) => figure.querySelector(`.${name}`);
    this.button = find("play");
    this.scrub = find("scrub");
    this.clock = find("clock");
    this.speed = find("speed");
    this.loop = find("loop");
    this.phase = find("phase-name");
    this.stage = new Stage(find("stage"));
    [this.start, this.end] = [Number(this.scrub.min), Number(this.scrub.max)];
    this.before = null;
    this.button.addEventListener("click", () => (this.playing ? this.pause() : this.play()));
    this.scrub.addEventListener("input", () => { this.pause(); this.lead(Number(this.scrub.value)); });
    this.seek(this.start);
  }

  get playing() { return this.before !== null; }

  play() {
    if (this.stage.t >= this.end) this.seek(this.start);
    this.before = performance.now();
    this.say("Pause", true);
    requestAnimationFrame((now) => this.tick(now));
  }

  pause() {
    this.before = null;
    this.say("Play", false);
  }

  say(words, pressed) {
    this.button.textContent = words;
    this.button.setAttribute("aria-pressed", String(pressed));
  }

  tick(now) {
    if (!this.playing) return;
    let t = this.stage.t + Math.max(0, now - this.before) / 1000 * Number(this.speed.value);
    this.before = now;
    if (t >= this.end && this.loop.checked) t = this.start;
    this.lead(Math.min(t, this.end));
    if (t >= this.end) return this.pause();
    requestAnimationFrame((next) => this.tick(next));
  }

  // Show a time here, and the plots with it.
  lead(t) {
    this.seek(t);
    show(t, this);
  }

  seek(t) {
    const kept = Math.min(this.end, Math.max(this.start, t));
    this.stage.draw(kept);
    this.scrub.value = String(kept);
    this.clock.textContent = `${kept.toFixed(3)} s`;
    this.phase.textContent = motion.clips.length > 1 ? this.stage.clip(kept).name : "";
  }
}

const player = new Player(document.querySelector(".player"));
followers.push((t, leader) => {
  if (leader === player) return;
  player.pause();
  player.seek(t);
});
