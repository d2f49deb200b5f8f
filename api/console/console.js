// The console. Whatever came from a user is put into the page as text, never as markup.
"use strict";

const byId = (id) => document.getElementById(id);
const POLL_MS = 2000;
let examples = [];

async function call(path, options = {}) {
  const headers = { ...options.headers };
  const key = sessionStorage.getItem("key");
  if (key) headers.Authorization = `Bearer ${key}`;
  const response = await fetch(path, { ...options, headers });
  byId("key-form").hidden = response.status !== 401;
  const text = await response.text();
  const body = text ? JSON.parse(text) : null;
  if (!response.ok) throw new Error(body?.detail ?? `HTTP ${response.status}`);
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

function row(job) {
  const made = document.createElement("tr");
  const created = new Date(job.created).toLocaleString();
  const ended = job.error ? job.error.message : job.solution_status ?? "";
  for (const text of [job.name, job.status, ended, progress(job), created]) {
    made.append(element("td", text));
  }
  made.append(actions(job));
  return made;
}

async function showJobs() {
  const page = await call("/v1/jobs?limit=20");
  byId("jobs").replaceChildren(...page.jobs.map(row));
  byId("no-jobs").hidden = page.jobs.length > 0;
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
  describe();
}

function describe() {
  const chosen = examples.find((one) => one.name === byId("example").value);
  byId("about").textContent = chosen ? chosen.description : "";
}

async function post() {
  const name = encodeURIComponent(byId("example").value);
  const problem = await call(`/v1/examples/${name}`);
  const headers = { "Content-Type": "application/json" };
  const job = await call("/v1/jobs", { method: "POST", headers, body: JSON.stringify(problem) });
  byId("answer").textContent = `Queued as ${job.id}.`;
}

async function attempt(action) {
  try {
    await action();
    await showJobs();
  } catch (error) {
    byId("answer").textContent = error.message;
  }
}

async function start() {
  await Promise.allSettled([showExamples(), showState(), showJobs()]);
}

byId("example").addEventListener("change", describe);
byId("post-form").addEventListener("submit", (event) => {
  event.preventDefault();
  attempt(post);
});
byId("key-form").addEventListener("submit", (event) => {
  event.preventDefault();
  sessionStorage.setItem("key", byId("key").value);
  start();
});
setInterval(() => {
  if (!document.hidden) Promise.allSettled([showState(), showJobs()]);
}, POLL_MS);
start();
