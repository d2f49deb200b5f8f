"use strict";
// Reads values under the pointer and toggles lines. The page is complete without it.
const SVG = "http://www.w3.org/2000/svg";
const figures = JSON.parse(document.getElementById("figures").textContent);

function clenshaw(row, s) {
  let next = 0, after = 0;
  for (let j = row.length - 1; j > 0; j--) [next, after] = [2 * s * next - after + row[j], next];
  return s * next - after + row[0];
}

function evaluate({ breaks, rows }, t) {
  if (t < breaks[0] || t > breaks[breaks.length - 1]) return null;
  let low = 0, high = rows.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (breaks[middle] <= t) low = middle; else high = middle - 1;
  }
  if (rows[low].includes(null)) return null;
  const width = breaks[low + 1] - breaks[low];
  return clenshaw(rows[low], width > 0 ? 2 * (t - breaks[low]) / width - 1 : 1);
}

function height({ y, log }, value) {
  const to = log ? (v) => Math.log10(Math.max(v, y[0])) : (v) => v;
  return 1 - (to(value) - to(y[0])) / (to(y[1]) - to(y[0]));
}

function make(name, kind, parent) {
  const element = document.createElementNS(SVG, name);
  element.setAttribute("class", kind);
  return parent.appendChild(element);
}

function tidy(value) {
  if (value === null) return "\u2013";
  const size = Math.abs(value), plain = value === 0 || (size >= 1e-3 && size < 1e6);
  return (plain ? value.toPrecision(5) : value.toExponential(2)).replaceAll("-", "\u2212");
}

const plots = [];

class Plot {
  constructor(canvas) {
    const figure = canvas.closest("figure");
    this.data = figures[Number(canvas.dataset.figure)];
    this.frame = canvas.querySelector(".frame");
    this.area = this.frame.querySelector(".data");
    this.now = figure.querySelector(".now");
    this.keys = [...figure.querySelectorAll(".key")];
    this.lines = [...this.frame.querySelectorAll(".series")];
    this.layer = make("g", "pointer hidden", this.frame);
    this.hair = make("line", "hair", this.layer);
    this.hair.setAttribute("y1", "0");
    this.hair.setAttribute("y2", "100%");
    this.dots = this.lines.map((line) => {
      const dot = make("circle", `dot ${line.classList[1]}`, this.layer);
      dot.setAttribute("r", "4.5");
      return dot;
    });
    this.listen(canvas);
  }

  listen(canvas) {
    canvas.addEventListener("pointermove", (event) => show(this.time(event.clientX)));
    canvas.addEventListener("pointerdown", (event) => show(this.time(event.clientX)));
    canvas.addEventListener("pointerleave", hide);
    canvas.addEventListener("blur", hide);
    canvas.addEventListener("keydown", (event) => this.step(event));
    this.keys.forEach((key, index) => key.addEventListener("click", () => this.toggle(key, index)));
  }

  time(clientX) {
    const box = this.area.getBoundingClientRect(), [start, end] = this.data.x;
    const share = (clientX - box.left) / box.width;
    return start + Math.min(1, Math.max(0, share)) * (end - start);
  }

  step(event) {
    const direction = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!direction) return;
    event.preventDefault();
    const [start, end] = this.data.x;
    const from = current === null ? (start + end) / 2 : current;
    show(Math.min(end, Math.max(start, from + direction * (end - start) / 100)));
  }

  toggle(key, index) {
    const on = key.getAttribute("aria-pressed") !== "true";
    key.setAttribute("aria-pressed", String(on));
    this.lines[index].classList.toggle("hidden", !on);
    this.dots[index].classList.toggle("off", !on);
  }

  show(t) {
    const [start, end] = this.data.x;
    const inside = t >= start && t <= end;
    this.layer.classList.toggle("hidden", !inside);
    if (!inside) return this.hide();
    const across = `${100 * (t - start) / (end - start)}%`;
    this.hair.setAttribute("x1", across);
    this.hair.setAttribute("x2", across);
    this.now.textContent = `t = ${tidy(t)} s`;
    this.data.series.forEach((series, index) => this.read(index, evaluate(series, t), across));
  }

  read(index, value, across) {
    const dot = this.dots[index], gone = value === null || dot.classList.contains("off");
    dot.classList.toggle("hidden", gone);
    this.keys[index].querySelector("output").textContent = tidy(value);
    if (gone) return;
    dot.setAttribute("cx", across);
    dot.setAttribute("cy", `${100 * height(this.data, value)}%`);
  }

  hide() {
    this.layer.classList.add("hidden");
    this.now.textContent = "";
    this.keys.forEach((key) => { key.querySelector("output").textContent = ""; });
  }
}

let current = null;
const followers = []; // what else shows the time under the pointer, and may lead it
function show(t, leader) {
  current = t;
  plots.forEach((plot) => plot.show(t));
  followers.forEach((follow) => follow(t, leader));
}
function hide() { current = null; plots.forEach((plot) => plot.hide()); }
document.querySelectorAll(".canvas[data-figure]").forEach((canvas) => plots.push(new Plot(canvas)));
