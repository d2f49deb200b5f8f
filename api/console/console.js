// The console. Whatever came from a user is put into the page as text, never as markup.
"use strict";

const byId = (id) => document.getElementById(id);
const POLL_MS = { idle: 2000, busy: 500 };
let examples = [];
let busy = false;
let shown = Promise.resolve(); // the problem in the editor is the chosen one

class Refusal extends Error {
  constructor(body, status) {
    super(body?.detail ?? `HTTP ${status}`);
    this.issues = body?.errors ?? [];
  }
}

async function call(path, options = {}) {
  const headers = { ...options.headers };
  const key = sessionStorage.getItem("key");
  if (key) headers.Authorization = `Bearer ${key}`;
  const response = await fetch(path, { ...options, headers });
  byId("key-form").hidden = response.status !== 401;
  const text = await response.text();
  const body = text ? JSON.parse(text) : null;
  if (!response.ok) throw new Refusal(body, response.status);
  return body;
}

function element(tag, text, attributes = {}) {
  const made = document.createElement(tag);
  made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

function progress(job) {
  if (job.queue_position !== null) return `number ${job.queue_position + 1} in the queue`;
  const at = job.progress;
  if (!at || !job.links.cancel) return ""; // it has not begun, or has ended
  if (job.kind === "simulation") return at.end === null ? at.stage : `${at.time.toPrecision(3)} of ${at.end} s`;
  return `${at.stage}, mesh ${at.mesh + 1} of ${at.segments} segments, iteration ${at.iteration}`;
}

function actions(job) {
  const cell = element("td", "");
  for (const name of ["result", "report.html"]) {
    if (job.links[name]) cell.append(element("a", name, { href: job.links[name] }), " ");
  }
  if (job.links.cancel) {
    const button = element("button", "cancel", { type: "button" });
    button.addEventListener("click", () => attempt(() => call(job.links.cancel, { method: "POST" })));
    cell.append(button);
  }
  return cell;
}

function cell(text, small) {
  const made = element("td", text);
  if (small) made.append(element("small", small));
  return made;
}

function row(job) {
  const made = element("tr", "", { id: job.id });
  const ended = job.error ? job.error.message : (job.solution_status ?? "").replaceAll("_", " ");
  const objective = job.progress?.objective;
  const value = job.solution_status && objective != null ? `objective ${objective.toPrecision(8)}` : "";
  made.append(
    cell(job.name, job.kind === "simulation" ? `simulation, ${job.id}` : job.id),
    cell(job.status, progress(job)),
    cell(ended, value),
    cell(new Date(job.created).toLocaleString()),
    actions(job),
  );
  return made;
}

// What has not changed stays in place, so that a button keeps its focus and its click.
function showRows(made) {
  const shown = [...byId("jobs").rows];
  const same = shown.length === made.length && shown.every((old, i) => old.id === made[i].id);
  if (!same) return byId("jobs").replaceChildren(...made);
  shown.forEach((old, i) => {
    [...made[i].cells].forEach((cell, j) => {
      if (!old.cells[j].isEqualNode(cell)) old.cells[j].replaceWith(cell);
    });
  });
}

async function showJobs() {
  const page = await call("/v1/jobs?limit=20");
  showRows(page.jobs.map(row));
  byId("no-jobs").hidden = page.jobs.length > 0;
  busy = page.jobs.some((job) => job.links.cancel);
}

function pointRow(point, places) {
  const made = element("tr", "");
  const values = places.map((place) => JSON.stringify(point.values[place] ?? null));
  const objective = point.objective === null ? "" : point.objective.toPrecision(8);
  const said = (point.solution_status ?? point.status).replaceAll("_", " ");
  made.append(...[point.index, ...values, objective, said].map((text) => element("td", text)));
  const links = element("td", "");
  if (point.links.result) links.append(element("a", "result", { href: point.links.result }));
  made.append(links);
  return made;
}

async function showPoints(details, sweep) {
  const { points } = await call(sweep.links.self);
  const places = [...new Set(points.flatMap((point) => Object.keys(point.values)))];
  const head = element("tr", "");
  const names = ["Point", ...places.map((place) => place.split("/").pop()), "Objective", "Solution", ""];
  head.append(...names.map((name) => element("th", name)));
  const table = element("table", "");
  table.append(head, ...points.map((point) => pointRow(point, places)));
  details.querySelector("div").replaceChildren(table);
}

function sweepDetails(sweep) {
  const details = element("details", "", { id: sweep.id });
  const ended = sweep.total - sweep.counts.queued - sweep.counts.running;
  const words = `${sweep.name}: ${sweep.status}, ${ended} of ${sweep.total} points have ended`;
  details.append(element("summary", words), element("div", "", { class: "scroll" }));
  details.addEventListener("toggle", () => details.open && attempt(() => showPoints(details, sweep)));
  return details;
}

// An open table stays as it is until it is closed.
async function showSweeps() {
  const { sweeps } = await call("/v1/sweeps?limit=5");
  byId("sweeps-section").hidden = sweeps.length === 0;
  if (byId("sweeps").querySelector("[open]")) return;
  byId("sweeps").replaceChildren(...sweeps.map(sweepDetails));
}

async function showState() {
  try {
    const ready = await call("/readyz");
    byId("state").textContent = `Ready. Workers: ${ready.workers}, waiting jobs: ${ready.waiting}.`;
  } catch (error) {
    byId("state").textContent = error.message;
  }
}

async function showExamples() {
  examples = (await call("/v1/examples")).examples;
  const options = examples.map((one) => element("option", one.title, { value: one.name }));
  byId("example").replaceChildren(...options);
  await (shown = showProblem());
}

async function showProblem() {
  const chosen = examples.find((one) => one.name === byId("example").value);
  byId("about").textContent = chosen ? chosen.description : "";
  const problem = chosen ? await call(`/v1/examples/${encodeURIComponent(chosen.name)}`) : {};
  byId("problem").value = JSON.stringify(problem, null, 2);
}

// A simulation has one system, a problem has phases; what is neither is refused as a problem.
function destination(body) {
  try {
    const { phases, system } = JSON.parse(body);
    return system !== undefined && phases === undefined ? "/v1/simulations" : "/v1/jobs";
  } catch {
    return "/v1/jobs";
  }
}

async function post() {
  await shown;
  const headers = { "Content-Type": "application/json" };
  const body = byId("problem").value;
  const job = await call(destination(body), { method: "POST", headers, body });
  byId("answer").textContent = `Queued as ${job.id}.`;
}

function showIssues(issues) {
  const place = (one) => [one.pointer, one.column && `column ${one.column}`].filter(Boolean).join(", ");
  const lines = issues.map((one) => {
    const made = element("li", `${place(one) || "/"}: ${one.message}`);
    if (one.hint) made.append(element("small", one.hint));
    return made;
  });
  byId("issues").replaceChildren(...lines);
}

async function attempt(action) {
  showIssues([]);
  try {
    await action();
    await showJobs();
  } catch (error) {
    const issues = error.issues ?? [];
    byId("answer").textContent = issues.length ? "The problem is refused:" : error.message;
    showIssues(issues);
  }
}

async function start() {
  await Promise.allSettled([showExamples(), showState(), showJobs(), showSweeps()]);
}

byId("example").addEventListener("change", () => attempt(() => (shown = showProblem())));
byId("post-form").addEventListener("submit", (event) => {
  event.preventDefault();
  attempt(post);
});
byId("key-form").addEventListener("submit", (event) => {
  event.preventDefault();
  sessionStorage.setItem("key", byId("key").value);
  start();
});
async function watch() {
  if (!document.hidden) await Promise.allSettled([showState(), showJobs(), showSweeps()]);
  setTimeout(watch, busy ? POLL_MS.busy : POLL_MS.idle);
}
start().then(watch);
