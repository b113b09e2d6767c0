"use strict";
// The page of `stubborn web`: shows the newest frame of the session, and sends commands over one websocket.

const $ = (id) => document.getElementById(id);
const figures = new Map([...document.querySelectorAll("figure")].map((figure) => [figure.dataset.name, figure]));
const phone = window.matchMedia("(max-width: 900px)");
const KEYS = {ArrowUp: 1, w: 1, ArrowLeft: 2, a: 2, ArrowRight: 3, d: 3, x: 0};
const RETRY_MS = [300, 600, 1200, 2500];

let socket = null;
let left = false;  // another page is shown; the browser may keep this one for its Back button
let failures = 0;
let choices = null;
let closed = false;  // the outcome of this episode: a state that comes again does not open it again
let state = {phase: "idle", driver: "agent", paused: false, per_s: 2};

// --- connection ---------------------------------------------------------------------------------------------------

function connect() {
  if (left || (socket && socket.readyState <= WebSocket.OPEN)) return;
  const opened = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live`);
  socket = opened;
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    failures = 0;
    linked("connected", false);
    showWanted();
  };
  socket.onmessage = (event) => (typeof event.data === "string" ? told(JSON.parse(event.data)) : shown(event.data));
  socket.onclose = () => {
    if (left || opened !== socket) return;
    linked("connection lost, trying again", true);
    setTimeout(reconnect, RETRY_MS[Math.min(failures++, RETRY_MS.length - 1)]);
  };
}

// The browser would keep the connection of a page that it keeps, and the server would count that page as open.
function leave() {
  left = true;
  if (socket) socket.close();
}

function comeBack(event) {
  if (!event.persisted) return;
  left = false;
  connect();
}

async function reconnect() {
  // A websocket that fails leaves an error in the console; a request that fails is asked for first and is caught.
  try {
    await fetch("api/choices", {cache: "no-store"});
  } catch {
    setTimeout(reconnect, RETRY_MS[Math.min(failures++, RETRY_MS.length - 1)]);
    return;
  }
  connect();
}

function linked(words, lost) {
  $("link").textContent = words;
  $("link").classList.toggle("lost", lost);
}

function send(message) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function showWanted() {
  const live = !$("live").hidden && document.visibilityState === "visible";
  send({do: "show", pictures: live ? [...figures.keys()] : []});
}

// --- what the server says -----------------------------------------------------------------------------------------

function told(news) {
  if (news.kind === "refused") {
    $("message").textContent = news.message;
    return;
  }
  state = news;
  document.body.dataset.phase = news.phase;
  document.body.dataset.driver = news.driver;
  const playing = news.phase === "playing";
  if (news.phase === "loading") document.body.dataset.step = "-1";
  $("message").textContent = news.message;
  $("driver").textContent = news.driver === "person" ? "you drive" : news.wish ? news.wish.agent : "agent";
  $("pause").textContent = news.paused ? "Run" : "Pause";
  $("pause").disabled = $("step").disabled = !playing || news.driver === "person";
  $("take").textContent = news.driver === "person" ? "Hand back" : "Take over";
  $("take").disabled = $("end").disabled = !playing;
  $("speed").value = String(news.per_s);
  for (const button of document.querySelectorAll(".pad button")) button.disabled = !playing;
  linked(news.clients > 1 ? `connected, ${news.clients} pages` : "connected", false);
  const outcome = news.phase === "ended" ? news.outcome : null;
  if (!outcome) closed = false;
  $("outcome").hidden = !outcome || closed;
  if (outcome) {
    $("outcome").className = `card outcome ${outcome.found ? "found" : "missed"}`;
    $("outcome-headline").textContent = outcome.headline;
    $("outcome-sentence").textContent = outcome.sentence;
    if (closed) $("doing").textContent = outcome.sentence;
  }
  if (news.legends) {
    $("segmentation-name").textContent = news.segmentation ? `Segmentation (${news.segmentation})` : "Segmentation";
    fill($("map-legend"), news.legends.map.map(([name, colour]) => legendItem(name, colour)));
    fill($("plan-legend"), news.legends.plan.map(([name, colour]) => legendItem(name, colour)));
  }
}

function closeOutcome() {
  if ($("outcome").hidden) return;
  const focused = $("outcome").contains(document.activeElement);
  closed = true;
  $("outcome").hidden = true;
  $("doing").textContent = $("outcome-sentence").textContent;
  if (focused) $("start").focus({preventScroll: true});
}

async function shown(buffer) {
  const length = new DataView(buffer).getUint32(0);
  const frame = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const present = new Set();
  const drawn = frame.pictures.map(([name, size]) => {
    const blob = new Blob([new Uint8Array(buffer, at, size)], {type: "image/jpeg"});
    at += size;
    present.add(name);
    return draw(figures.get(name), blob);
  });
  facts(frame);
  if (!frame.ended && frame.pictures.length) {
    for (const [name, figure] of figures) figure.classList.toggle("absent", !present.has(name));
  }
  await Promise.all(drawn);
  document.body.dataset.step = frame.step;
}

async function draw(figure, blob) {
  const bitmap = await createImageBitmap(blob);
  const canvas = figure.querySelector("canvas");
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) {
    canvas.width = bitmap.width;
    canvas.height = bitmap.height;
  }
  canvas.getContext("2d").drawImage(bitmap, 0, 0);
  bitmap.close();
}

function facts(frame) {
  const words = [`step ${frame.step}${state.max_steps ? ` of ${state.max_steps}` : ""}`];
  if (frame.last) words.push(frame.last);
  words.push(`driven ${frame.driven_m.toFixed(1)} m`);
  words.push(frame.left_m === null ? "no path to the goal" : `${frame.left_m.toFixed(1)} m to go`);
  if (frame.shortest_m !== null) words.push(`shortest path ${frame.shortest_m.toFixed(1)} m`);
  const hits = document.createElement(frame.collided ? "b" : "span");
  hits.textContent = `${frame.collisions} collision${frame.collisions === 1 ? "" : "s"}`;
  fill($("facts"), [document.createTextNode(`${words.join(", ")}, `), hits]);
  document.body.classList.toggle("hit", frame.collided);
  const advice = state.driver === "person" && frame.advice ? `The agent would: ${frame.advice}. ` : "";
  $("doing").textContent = advice + (frame.doing ? `Agent: ${frame.doing}.` : "");
  fill($("sight"), frame.in_sight.map((item) => legendItem(item.name, item.colour, item.goal)));
}

function legendItem(name, colour, goal = false) {
  const item = document.createElement("li");
  const swatch = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  swatch.setAttribute("width", "14");
  swatch.setAttribute("height", "14");
  const square = document.createElementNS("http://www.w3.org/2000/svg", "rect");
  square.setAttribute("width", "14");
  square.setAttribute("height", "14");
  square.setAttribute("fill", colour);
  swatch.append(square);
  item.append(swatch, document.createTextNode(goal ? `${name} (the goal)` : name));
  item.classList.toggle("goal", goal);
  return item;
}

function fill(parent, children) {
  parent.replaceChildren(...children);
}

// --- choosing an episode --------------------------------------------------------------------------------------------

function options(select, values, wanted) {
  const before = wanted ?? select.value;
  fill(select, values.map((value) => new Option(value.replaceAll("_", " "), value)));
  if (values.includes(before)) select.value = before;
}

function chosenSplit() {
  options($("house"), Object.keys(choices.splits[$("split").value]));
  chosenHouse();
}

function chosenHouse() {
  options($("goal"), choices.splits[$("split").value][$("house").value]);
}

function chosenAgent() {
  const agent = $("agent").value;
  $("semantics").disabled = !choices.uses_segmentation[agent];
  $("agent-note").textContent = `${agent}: ${choices.agents[agent]}. ${$("semantics").value}: ${choices.semantics[$("semantics").value]}.`;
}

function start(driver) {
  const wish = {do: "start", driver};
  for (const name of ["split", "house", "goal", "agent", "semantics"]) wish[name] = $(name).value;
  send(wish);
  if (phone.matches) window.scrollTo(0, 0);
}

async function choose() {
  choices = await (await fetch("api/choices")).json();
  options($("split"), Object.keys(choices.splits));
  options($("agent"), Object.keys(choices.agents), "stubborn");
  options($("semantics"), Object.keys(choices.semantics), "rednet");
  $("run-command").textContent = choices.run_command;
  chosenSplit();
  chosenAgent();
}

// --- finished runs ------------------------------------------------------------------------------------------------

async function listRuns() {
  const runs = await (await fetch("api/runs")).json();
  $("no-runs").hidden = runs.length > 0;
  fill($("run-list"), runs.map((run) => {
    const item = document.createElement("li"), button = document.createElement("button"), about = document.createElement("small");
    button.type = "button";
    button.append(run.name, about);
    const errors = run.errors ? `, ${run.errors} error${run.errors === 1 ? "" : "s"}` : "";
    about.textContent = `${run.agent ?? "?"}, ${run.split ?? "?"}: ${run.found} of ${run.episodes} found${errors}, SPL ${run.spl.toFixed(2)}`;
    button.addEventListener("click", () => openRun(run));
    item.append(button);
    return item;
  }));
}

async function openRun(run) {
  const address = `runs/${encodeURIComponent(run.name)}`;
  const lines = await (await fetch(`api/${address}`)).json();
  $("run").hidden = false;
  $("run-name").textContent = run.name;
  $("run-report").href = `${address}/report.html`;
  $("run-report").parentElement.hidden = !run.report;
  $("video").hidden = true;
  $("video").removeAttribute("src");
  $("video-title").textContent = "";
  fill($("episodes"), lines.map((line) => episodeRow(line, address)));
  $("run").scrollIntoView({block: "nearest"});
}

function episodeRow(line, address) {
  const row = document.createElement("tr");
  const outcome = line.success ? "found" : line.end_reason === "error" ? "error" : (line.failure ?? line.end_reason ?? "").replaceAll("_", " ");
  for (const [words, kind] of [[line.episode_id, ""], [(line.goal ?? "").replaceAll("_", " "), ""], [outcome, line.success ? "good" : "bad"], [line.num_steps ?? "", "number"], [Number(line.spl ?? 0).toFixed(2), "number"]]) {
    const cell = document.createElement("td");
    cell.textContent = words;
    cell.className = kind;
    row.append(cell);
  }
  const last = document.createElement("td");
  if (line.video) {
    const play = document.createElement("button");
    play.type = "button";
    play.textContent = "Video";
    play.addEventListener("click", () => {
      $("video").hidden = false;
      $("video").src = `${address}/video?episode=${encodeURIComponent(line.episode_id)}`;
      $("video-title").textContent = `${line.episode_id}: ${outcome}`;
      $("video").play().catch(() => {});
      $("video").scrollIntoView({block: "nearest"});
    });
    last.append(play);
  }
  row.append(last);
  return row;
}

function tab(name) {
  for (const each of ["live", "runs"]) {
    $(each).hidden = each !== name;
    $(`tab-${each}`).setAttribute("aria-pressed", String(each === name));
  }
  showWanted();
  if (name === "runs") listRuns();
}

// --- controls -----------------------------------------------------------------------------------------------------

function key(event) {
  const typing = event.target.closest("select, input, video");
  if (typing || event.ctrlKey || event.metaKey || event.altKey || $("live").hidden || state.phase !== "playing") return;
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (name in KEYS) {
    if (!(KEYS[name] === 0 && event.repeat)) send({do: "act", action: KEYS[name]});
  } else if (name === " ") toggle();
  else if (name === "n") send({do: "step"});
  else if (name === "t") take();
  else return;
  event.preventDefault();
}

const toggle = () => send({do: state.paused ? "run" : "pause"});
const take = () => send({do: state.driver === "person" ? "agent" : "person"});

function hold(button) {
  // A held button drives on, as a held key does.
  let timer = null;
  const act = () => send({do: "act", action: Number(button.dataset.action)});
  const release = () => clearInterval(timer);
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || button.disabled) return;
    act();
    if (button.dataset.action !== "0") timer = setInterval(act, 350);
  });
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(end, release);
  button.addEventListener("click", (event) => { if (event.detail === 0) act(); });  // by the keyboard
  button.addEventListener("contextmenu", (event) => event.preventDefault());
}

document.addEventListener("keydown", (event) => (event.key === "Escape" ? closeOutcome() : key(event)));
$("close-outcome").addEventListener("click", closeOutcome);
document.addEventListener("visibilitychange", showWanted);
addEventListener("pagehide", leave);
addEventListener("pageshow", comeBack);
$("choose").addEventListener("submit", (event) => { event.preventDefault(); start("agent"); });
$("start-driving").addEventListener("click", () => start("person"));
$("split").addEventListener("change", chosenSplit);
$("house").addEventListener("change", chosenHouse);
$("agent").addEventListener("change", chosenAgent);
$("semantics").addEventListener("change", chosenAgent);
$("pause").addEventListener("click", toggle);
$("step").addEventListener("click", () => send({do: "step"}));
$("speed").addEventListener("change", () => send({do: "speed", per_s: Number($("speed").value)}));
$("take").addEventListener("click", take);
$("end").addEventListener("click", () => send({do: "stop"}));
$("tab-live").addEventListener("click", () => tab("live"));
$("tab-runs").addEventListener("click", () => tab("runs"));
document.querySelectorAll(".pad button").forEach(hold);
for (const figure of figures.values()) {
  figure.addEventListener("click", () => {
    if (phone.matches) {
      figures.get("camera").parentElement.prepend(figure);
    } else if (!figure.classList.contains("big")) {
      [...figures.values()].find((other) => other.classList.contains("big") && other.dataset.name !== "camera").classList.remove("big");
      figure.classList.add("big");
    }
  });
}
choose().then(connect);
