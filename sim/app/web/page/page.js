"use strict";
// The page of `stubborn web`: shows the newest frame of the session, and sends commands over one websocket.

const $ = (id) => document.getElementById(id);
const figures = new Map([...document.querySelectorAll("figure")].map((figure) => [figure.dataset.name, figure]));
const phone = window.matchMedia("(max-width: 900px)");
const KEYS = {ArrowUp: 1, w: 1, ArrowLeft: 2, a: 2, ArrowRight: 3, d: 3, x: 0};
const RETRY_MS = [300, 600, 1200, 2500];

let socket = null;
let left = false;  // true: another page is shown; the browser may keep this one for its Back button
let failures = 0;
let choices = null;
let seen = false;  // true: this page was open before the end of the episode, whose outcome is then new
let closed = false;  // true: the outcome of this episode is not new, or the user has closed it; no state opens it again
let state = {phase: "idle", driver: "agent", paused: false, per_s: 2, hints: false};

// --- connection ---------------------------------------------------------------------------------------------------

function connect() {
  if (left || (socket && socket.readyState <= WebSocket.OPEN)) return;
  const opened = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/live`);
  socket = opened;
  socket.binaryType = "arraybuffer";
  socket.onopen = () => {
    failures = 0;
    showConnection("connected", false);
    showWanted();
  };
  socket.onmessage = (event) => (typeof event.data === "string" ? showState(JSON.parse(event.data)) : showFrame(event.data));
  socket.onclose = () => {
    if (left || opened !== socket) return;
    showConnection("connection lost, trying again", true);
    setTimeout(reconnect, RETRY_MS[Math.min(failures++, RETRY_MS.length - 1)]);
  };
}

// Without this, the browser would keep the connection of a page that it keeps, and the server would count that page.
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
  // A websocket that fails leaves an error in the console. A request that fails does not, so it is tried first.
  try {
    await fetch("api/choices", {cache: "no-store"});
  } catch {
    setTimeout(reconnect, RETRY_MS[Math.min(failures++, RETRY_MS.length - 1)]);
    return;
  }
  connect();
}

function showConnection(words, lost) {
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

// --- messages of the server ---------------------------------------------------------------------------------------

function showState(news) {
  if (news.kind === "refused") {
    $("message").textContent = news.message;
    following = false;
    return;
  }
  state = news;
  document.body.dataset.phase = news.phase;
  document.body.dataset.driver = news.driver;
  const running = news.phase === "running";
  if (following && news.phase === "loading") follow(news.request);
  if (news.phase === "loading") {
    document.body.dataset.step = "-1";
    for (const id of ["facts", "doing", "sight"]) fill($(id), []);  // those of the last episode
    document.body.classList.remove("hit");
    for (const figure of figures.values()) figure.classList.replace("absent", "empty") || figure.classList.add("empty");
  }
  // Nothing was shown of an episode that failed before its first step: the house is shown again.
  if (["failed", "idle"].includes(news.phase) && document.body.dataset.step === "-1") delete document.body.dataset.step;
  const outcome = news.phase === "ended" ? news.outcome : null;
  seen ||= news.phase !== "ended";
  closed = Boolean(outcome) && (closed || !seen);
  $("message").textContent = outcome && !seen ? `Last episode: ${news.message}` : news.message;
  $("driver").textContent = news.driver === "person" ? "you drive" : news.request ? news.request.agent : "agent";
  $("pause").textContent = news.paused ? "Run" : "Pause";
  $("pause").disabled = $("step").disabled = !running || news.driver === "person";
  $("take").textContent = news.driver === "person" ? "Hand back" : "Take over";
  $("end").disabled = !running;
  $("take").disabled = !running || !news.request.goal;
  $("hints").setAttribute("aria-pressed", String(news.hints));
  if (!running) hint(null);
  $("note").textContent = news.note || "";
  $("note").hidden = !news.note;
  $("speed").value = String(news.per_s);
  for (const button of document.querySelectorAll(".pad button")) button.disabled = !running;
  showConnection(news.clients > 1 ? `connected, ${news.clients} pages` : "connected", false);
  $("outcome").hidden = !outcome || closed;
  if (outcome) {
    $("outcome").className = `card outcome ${outcome.found ? "found" : "missed"}`;
    $("outcome-headline").textContent = outcome.headline;
    $("outcome-sentence").textContent = outcome.sentence;
    $("outcome-recorded").textContent = outcome.recorded;
    if (closed) $("doing").textContent = outcome.sentence;
  }
  if (news.legends) {
    $("segmentation-name").textContent = news.segmentation ? `Segments (${news.segmentation})` : "Segmentation";
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

async function showFrame(buffer) {
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
  figure.classList.remove("empty");
  bitmap.close();
}

function facts(frame) {
  const words = [state.episode_id, `step ${frame.step}${state.max_steps ? ` of ${state.max_steps}` : ""}`];
  if (!state.episode_id) words.shift();
  if (frame.last) words.push(frame.last);
  words.push(`driven ${frame.driven_m.toFixed(1)} m`);
  if (state.request?.goal) words.push(frame.left_m === null ? "no path to the goal" : `${frame.left_m.toFixed(frame.left_m < 1 ? 2 : 1)} m to go`);
  if (frame.shortest_m !== null) words.push(`shortest path ${frame.shortest_m.toFixed(1)} m`);
  const hits = document.createElement(frame.collided ? "b" : "span");
  hits.textContent = `${frame.collisions} collision${frame.collisions === 1 ? "" : "s"}`;
  fill($("facts"), [document.createTextNode(`${words.join(", ")}, `), hits]);
  document.body.classList.toggle("hit", frame.collided);
  hint(frame.hint);
  const advice = state.driver === "person" && frame.advice ? `The agent would: ${frame.advice}. ` : "";
  const shortest = frame.hint ? `Shortest path: ${frame.hint.words}. ` : "";
  if (!closed) $("doing").textContent = shortest + advice + (frame.doing ? `Agent: ${frame.doing}.` : "");
  fill($("goals"), frame.goals.map(goalItem));
  if (frame.goals.length && state.phase === "running") $("message").textContent = frame.looking;
  fill($("sight"), frame.in_sight.map((item) => legendItem(item.name, item.colour, item.goal)));
}

// A goal of a chain: found, missed, the present one, or a later one.
function goalItem(goal) {
  const item = document.createElement("li");
  item.textContent = goal.words;
  if (goal.present) item.setAttribute("aria-current", "step");
  item.className = goal.found === null ? (goal.present ? "present" : "") : goal.found ? "found" : "missed";
  return item;
}

function hint(shown) {
  for (const button of document.querySelectorAll(".pad button")) {
    button.classList.toggle("hinted", shown !== null && Number(button.dataset.action) === shown.action);
  }
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

function options(select, values, wanted, empty = "its own", words = shortened) {
  const before = wanted ?? select.value;
  fill(select, values.map((value) => new Option(words(value) || empty, value)));
  if (values.includes(before)) select.value = before;
}

// A category or a name in words.
const plain = (name) => (name === "tv_monitor" ? "television" : name.replaceAll("_", " "));

// Of a path, only the last name is shown.
const shortened = (value) => (value.includes("/") ? value.replace(/\/+$/, "").split("/").at(-1) : value);

const goalsNow = () => choices.splits[$("split").value][$("house").value];

function chosenSplit() {
  options($("house"), Object.keys(choices.splits[$("split").value]));
  const houses = Object.values(choices.splits[$("split").value]);
  const ids = houses.flatMap((goals) => Object.values(goals).flat());
  fill($("episode-ids"), ids.map((id) => new Option(id, id)));
  $("episode").value = "";
  chosenHouse();
}

function chosenHouse() {
  goalOptions();
  chosenGoal();
  showHouse();
}

// --- the house before the start -------------------------------------------------------------------------------------

let above = null;  // the house that is shown: its picture, the place in its middle, metres per pixel

// Shows the house in place of the last episode's pictures; a running episode goes on.
function showAbove() {
  if (["running", "loading"].includes(state.phase)) return;
  delete document.body.dataset.step;
  closeOutcome();
}

// Proposes the descriptions that ship for a house of val.
function proposeWishes(split, house) {
  const texts = split === "val" ? Object.keys(choices.splits.descriptions?.[house] ?? {}) : [];
  fill($("wishes"), texts.map((text) => new Option(text)));
  $("wish").placeholder = [...texts].sort((a, b) => a.length - b.length)[0] ?? "the wooden chair";
}

async function showHouse() {
  const asked = {split: $("split").value, house: $("house").value};
  proposeWishes(asked.split, asked.house);
  $("place").value = "";
  above = null;
  $("above-words").textContent = `Drawing ${asked.house} ...`;
  const answer = await fetch(`api/house?${new URLSearchParams(asked)}`);
  if ($("split").value !== asked.split || $("house").value !== asked.house) return;  // another one was chosen since
  $("above").classList.toggle("missing", !answer.ok);
  if (!answer.ok) {
    $("above-words").textContent = await answer.text();
    return;
  }
  const house = await answer.json();
  const bytes = Uint8Array.from(atob(house.jpeg), (letter) => letter.charCodeAt(0));
  above = {...house, picture: await createImageBitmap(new Blob([bytes], {type: "image/jpeg"}))};
  drawHouse();
}

// x, y and direction in the field; null: there is no start in it.
function chosenPlace() {
  const numbers = $("place").value.trim().split(/[\s,]+/).map(Number);
  if (!$("place").value.trim() || numbers.length < 2 || numbers.some((number) => !Number.isFinite(number))) return null;
  return [numbers[0], numbers[1], numbers[2] ?? 0];
}

function drawHouse() {
  if (!above) return;
  const canvas = $("above-picture"), pen = canvas.getContext("2d"), place = chosenPlace();
  canvas.width = above.picture.width;
  canvas.height = above.picture.height;
  pen.drawImage(above.picture, 0, 0);
  $("above-words").textContent = `${shortened($("house").value)} from above. ` + (place ? "Start: the arrow." : "Press to choose a start, drag to turn it.");
  if (!place) return;
  const x = (place[0] - above.middle_m[0]) / above.m_per_px + canvas.width / 2;
  const y = canvas.height / 2 - (place[1] - above.middle_m[1]) / above.m_per_px;
  const turn = place[2] * Math.PI / 180, size = Math.max(9, 0.25 / above.m_per_px);
  pen.translate(x, y);
  pen.rotate(-turn);
  pen.beginPath();
  for (const [ahead, left] of [[1.6, 0], [-1, 0.9], [-0.5, 0], [-1, -0.9]]) pen.lineTo(ahead * size, -left * size);
  pen.closePath();
  pen.lineWidth = 3;
  pen.strokeStyle = "#fff";
  pen.fillStyle = "#c4146c";
  pen.stroke();
  pen.fill();
}

function placeAt(event) {
  const box = $("above-picture").getBoundingClientRect(), scale = $("above-picture").width / box.width;
  const x = (event.clientX - box.left) * scale - $("above-picture").width / 2;
  const y = $("above-picture").height / 2 - (event.clientY - box.top) * scale;
  return [x * above.m_per_px + above.middle_m[0], y * above.m_per_px + above.middle_m[1]];
}

let pressed = null;  // where the pointer went down on the picture, metres

function press(event) {
  if (!above || event.button !== 0) return;
  pressed = placeAt(event);
  event.currentTarget.setPointerCapture(event.pointerId);
  aim(event);
}

function aim(event) {
  if (!pressed) return;
  const [x, y] = placeAt(event), far = Math.hypot(x - pressed[0], y - pressed[1]) > 0.2;
  const deg = far ? Math.atan2(y - pressed[1], x - pressed[0]) * 180 / Math.PI : chosenPlace()?.[2] ?? 0;
  $("place").value = `${pressed[0].toFixed(2)} ${pressed[1].toFixed(2)} ${deg.toFixed(0)}`;
  drawHouse();
}

const goalOptions = (wanted) => options($("goal"), Object.keys(goalsNow()), wanted, "no goal", plain);

// Removes the chosen episode if it is of another house or goal. An agent needs a goal.
function chosenGoal() {
  $("start").disabled = !$("goal").value && !$("wish").value.trim();
  const ids = goalsNow()[$("goal").value];
  if (ids.length && !ids.includes($("episode").value)) $("episode").value = "";
}

// Selects the house and the goal of the chosen episode.
function chosenEpisode() {
  const id = $("episode").value;
  for (const [house, goals] of Object.entries(choices.splits[$("split").value])) {
    for (const [goal, ids] of Object.entries(goals)) {
      if (!ids.includes(id)) continue;
      const other = $("house").value !== house;
      $("house").value = house;
      goalOptions(goal);
      if (other) showHouse();
    }
  }
}

function chosenAgent() {
  const agent = choices.agents[$("agent").value];
  $("semantics").disabled = !agent.segmentation;
  $("explorer").disabled = !agent.explorer;
  const described = [[$("agent").value, agent.description], [$("semantics").value, choices.semantics[$("semantics").value]]];
  $("agent-note").textContent = described.map(([name, words]) => (words ? `${name}: ${words.replace(/\.$/, "")}.` : `${name}.`)).join(" ");
}

// Shows the episode of a finished run in the form.
function follow(request) {
  following = false;
  if (!(request.split in choices.splits)) return;
  $("split").value = request.split;
  chosenSplit();
  $("house").value = request.house;
  goalOptions(request.goal);
  $("wish").value = request.goal in goalsNow() ? "" : request.goal;
  for (const name of ["agent", "semantics", "explorer"]) $(name).value = request[name];
  $("episode").value = request.episode_id ?? "";
  chosenAgent();
  showHouse();
}

function start(driver) {
  const request = {do: "start", driver};
  for (const name of ["split", "house", "goal", "agent", "semantics"]) request[name] = $(name).value;
  const wish = $("wish").value.trim();
  if (wish) request.goal = wish;
  request.episode = wish ? "" : $("episode").value.trim();
  const place = chosenPlace();
  if (place) request.start = place;
  request.explorer = $("explorer").disabled ? "" : $("explorer").value;
  send(request);
  if (phone.matches) window.scrollTo(0, 0);
}

async function choose() {
  choices = await (await fetch("api/choices")).json();
  options($("split"), Object.keys(choices.splits), choices.first.split);
  options($("agent"), Object.keys(choices.agents), choices.first.agent);
  options($("explorer"), ["", ...choices.explorers], choices.first.explorer);
  options($("semantics"), Object.keys(choices.semantics), choices.first.semantics);
  $("run-command").textContent = choices.run_command;
  chosenSplit();
  chosenAgent();
}

// --- finished runs ------------------------------------------------------------------------------------------------

let runs = [];
let following = false;  // true: the next episode that begins is the one that was requested here
let opened = null;  // the run whose episodes are shown: its name, address and result lines
const marked = new Set();  // names of the runs to compare, in the order of the clicks

async function listRuns() {
  runs = await (await fetch("api/runs")).json();
  for (const name of marked) if (!runs.some((run) => run.name === name)) marked.delete(name);
  showRuns();
}

function showRuns() {
  const words = $("run-filter").value.toLowerCase().split(/\s+/).filter(Boolean);
  const fits = (run) => words.every((word) => runWords(run).some((text) => text.toLowerCase().includes(word)));
  $("no-runs").hidden = runs.length > 0;
  fill($("run-list"), runs.filter(fits).map(runRow));
  $("compare").disabled = marked.size !== 2;
}

const runWords = (run) => [run.name, run.agent, run.explorer, run.segmentation, run.split].filter(Boolean);
const day = (seconds) => new Date(seconds * 1000).toLocaleString([], {dateStyle: "medium", timeStyle: "short"});

function runRow(run) {
  const mark = document.createElement("input"), open = document.createElement("button");
  mark.type = "checkbox";
  mark.checked = marked.has(run.name);
  mark.disabled = Boolean(run.broken);
  mark.setAttribute("aria-label", `compare ${run.name}`);
  mark.addEventListener("change", () => {
    if (mark.checked) marked.add(run.name);
    else marked.delete(run.name);
    if (marked.size > 2) marked.delete([...marked][0]);
    showRuns();
  });
  open.type = "button";
  open.textContent = run.name;
  open.disabled = Boolean(run.broken);
  open.addEventListener("click", () => openRun(run));
  const head = [[mark, ""], [open, ""], [day(run.changed_s), ""]];
  if (run.broken) {
    const line = row([...head, [run.broken, "bad wide"]]);
    line.lastChild.colSpan = 5;
    return line;
  }
  const errors = run.errors ? `, ${run.errors} error${run.errors === 1 ? "" : "s"}` : "";
  const agent = [run.agent ?? "?", run.explorer].filter(Boolean).join(", ");
  return row([...head, [agent, ""], [run.segmentation, ""], [run.split ?? "?", ""], [`${run.found} of ${run.episodes}${errors}`, ""], [run.episodes ? run.spl.toFixed(2) : "", "number"]]);
}

// A table row of cells, each a text or an element with a class.
function row(cells) {
  const line = document.createElement("tr");
  for (const [content, kind] of cells) {
    const cell = document.createElement("td");
    cell.append(content);
    cell.className = kind;
    line.append(cell);
  }
  return line;
}

async function compare() {
  const [second, first] = runs.map((run) => run.name).filter((name) => marked.has(name));  // the older one first
  const answer = await fetch(`api/comparison?${new URLSearchParams({first, second})}`);
  $("comparison").hidden = false;
  $("comparison-message").hidden = answer.ok;
  $("comparison-message").textContent = answer.ok ? "" : await answer.text();
  fill($("comparison-tables"), answer.ok ? comparisonShown(...(await answer.json())) : []);
  await offerReplay(first, second, answer.ok);
  $("comparison").scrollIntoView({block: "nearest"});
}

// --- two runs side by side ------------------------------------------------------------------------------------------

const replayed = ["first", "second"].map((name) => $(`replay-${name}`));
let replaying = null;  // timer of the time that is shown while both play

async function offerReplay(first, second, comparable) {
  stopReplay();
  const lines = [];
  for (const name of comparable ? [first, second] : []) {
    const answer = await fetch(`api/runs/${encodeURIComponent(name)}`);
    lines.push(answer.ok ? (await answer.json()).filter((line) => line.video).map((line) => line.episode_id) : []);
  }
  const common = comparable ? lines[0].filter((id) => lines[1].includes(id)) : [];
  $("replay").hidden = !common.length;
  $("no-replay").hidden = !comparable || common.length > 0;
  options($("replay-episode"), common);
  $("replay-first-name").textContent = `A: ${first}`;
  $("replay-second-name").textContent = `B: ${second}`;
  $("replay").dataset.runs = JSON.stringify([first, second]);
  if (common.length) chooseReplay();
}

function chooseReplay() {
  stopReplay();
  JSON.parse($("replay").dataset.runs).forEach((run, number) => {
    replayed[number].src = `runs/${encodeURIComponent(run)}/video?episode=${encodeURIComponent($("replay-episode").value)}`;
  });
  $("replay-at").value = 0;
}

const longest_s = () => Math.max(...replayed.map((video) => video.duration || 0));

function showTime() {
  const at = Math.max(...replayed.map((video) => video.currentTime));
  $("replay-at").max = longest_s() || 1;
  $("replay-at").value = at;
  $("replay-time").textContent = `${at.toFixed(1)} of ${longest_s().toFixed(1)} s`;
  if (replaying && replayed.every((video) => video.ended || video.paused)) stopReplay();
}

function scrub() {
  stopReplay();
  const at = Number($("replay-at").value);
  for (const video of replayed) video.currentTime = Math.min(at, video.duration || at);
  $("replay-time").textContent = `${at.toFixed(1)} of ${longest_s().toFixed(1)} s`;
}

function stopReplay() {
  clearInterval(replaying);
  replaying = null;
  for (const video of replayed) video.pause();
  $("replay-play").textContent = "Play";
}

async function playReplay() {
  if (replaying) return stopReplay();
  if (Number($("replay-at").value) >= longest_s() - 0.05) for (const video of replayed) video.currentTime = 0;
  await Promise.all(replayed.map((video) => (video.currentTime < video.duration ? video.play().catch(() => {}) : null)));
  $("replay-play").textContent = "Pause";
  replaying = setInterval(showTime, 100);
}

async function deleteRun() {
  const button = $("run-delete");
  if (button.dataset.sure !== opened.name) {  // the first click asks
    button.dataset.sure = opened.name;
    button.textContent = "Really delete?";
    return;
  }
  const answer = await fetch(`api/${opened.address}`, {method: "DELETE"});
  $("video-title").textContent = answer.ok ? "" : await answer.text();
  if (!answer.ok) return;
  $("run").hidden = true;
  $("comparison").hidden = true;
  stopReplay();
  listRuns();
}

function comparisonShown(means, differences) {
  const details = document.createElement("details"), summary = document.createElement("summary");
  summary.textContent = `${differences.title} (${differences.rows.length})`;
  details.append(summary, ...comparisonTable(differences));
  return [...comparisonTable(means), details];
}

function comparisonTable(shown) {
  const table = document.createElement("table"), head = document.createElement("tr"), body = document.createElement("tbody");
  for (const name of shown.header) head.append(Object.assign(document.createElement("th"), {textContent: name}));
  body.append(...shown.rows.map((cells) => row(cells.map((cell) => (typeof cell === "string" ? [cell, ""] : [cell.text, ""])))));
  table.append(Object.assign(document.createElement("caption"), {textContent: shown.title}), head, body);
  return [table, ...shown.notes.map((note) => Object.assign(document.createElement("p"), {textContent: note, className: "note"}))];
}

async function openRun(run) {
  const address = `runs/${encodeURIComponent(run.name)}`;
  const answer = await fetch(`api/${address}`);
  if (!answer.ok) return;
  opened = {name: run.name, address, lines: await answer.json()};
  $("run").hidden = false;
  $("run-name").textContent = run.name;
  $("run-report").href = `${address}/report.html`;
  $("run-report").hidden = !run.report;
  $("run-download").href = `${address}/run.zip`;
  $("run-delete").textContent = "Delete";
  delete $("run-delete").dataset.sure;
  $("video").hidden = true;
  $("video").removeAttribute("src");
  $("video-title").textContent = "";
  showEpisodes();
  $("run").scrollIntoView({block: "nearest"});
}

function showEpisodes() {
  const wanted = $("outcome-filter").value;
  const lines = opened.lines.filter((line) => wanted === "all" || (line.success === 1) === (wanted === "found"));
  fill($("episodes"), lines.map(episodeRow));
}

function episodeRow(line) {
  const outcome = line.success === 1 ? "found" : line.end_reason === "error" ? "error" : plain(line.failure ?? line.end_reason ?? "");
  const buttons = document.createElement("div");
  buttons.className = "buttons";
  const add = (words, action) => {
    const button = Object.assign(document.createElement("button"), {type: "button", textContent: words});
    button.addEventListener("click", action);
    buttons.append(button);
  };
  const again = (driver) => {
    tab("live");
    following = true;
    send({do: "again", driver, run: opened.name, episode: line.episode_id});
  };
  add("Watch", () => again("agent"));
  add("Drive", () => again("person"));
  if (line.video) add("Video", () => showVideo(line, outcome));
  return row([[line.episode_id, ""], [line.house ?? "", ""], [plain(line.goal ?? ""), ""], [outcome, line.success ? "good" : "bad"], [line.num_steps ?? "", "number"], [Number(line.spl ?? 0).toFixed(2), "number"], [buttons, ""]]);
}

function showVideo(line, outcome) {
  $("video").hidden = false;
  $("video").src = `${opened.address}/video?episode=${encodeURIComponent(line.episode_id)}`;
  $("video-title").textContent = `${line.episode_id}: ${outcome}`;
  $("video").play().catch(() => {});
  $("video").scrollIntoView({block: "nearest"});
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
  if (typing || event.ctrlKey || event.metaKey || event.altKey || $("live").hidden || state.phase !== "running") return;
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  if (name in KEYS) {
    if (!(KEYS[name] === 0 && event.repeat)) send({do: "act", action: KEYS[name]});
  } else if (name === " ") toggle();
  else if (name === "n") send({do: "step"});
  else if (name === "t") take();
  else if (name === "h") hints();
  else return;
  event.preventDefault();
}

const toggle = () => send({do: state.paused ? "run" : "pause"});
const take = () => send({do: state.driver === "person" ? "agent" : "person"});
const hints = () => send({do: "hints", on: !state.hints});

function hold(button) {
  // A button that is held repeats its action, as a key that is held does.
  let timer = null;
  const act = () => send({do: "act", action: Number(button.dataset.action)});
  const release = () => clearInterval(timer);
  button.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || button.disabled) return;
    act();
    if (button.dataset.action !== "0") timer = setInterval(act, 350);
  });
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(end, release);
  button.addEventListener("click", (event) => { if (event.detail === 0) act(); });  // a click by the keyboard
  button.addEventListener("contextmenu", (event) => event.preventDefault());
}

document.addEventListener("keydown", (event) => (event.key === "Escape" ? closeOutcome() : key(event)));
$("close-outcome").addEventListener("click", closeOutcome);
document.addEventListener("visibilitychange", showWanted);
addEventListener("pagehide", leave);
addEventListener("pageshow", comeBack);
$("choose").addEventListener("submit", (event) => { event.preventDefault(); start("agent"); });
$("start-driving").addEventListener("click", () => start("person"));
$("split").addEventListener("change", () => { chosenSplit(); showAbove(); });
$("house").addEventListener("change", () => { chosenHouse(); showAbove(); });
$("goal").addEventListener("change", () => { $("wish").value = ""; chosenGoal(); });
$("wish").addEventListener("input", chosenGoal);
$("episode").addEventListener("change", chosenEpisode);
$("agent").addEventListener("change", chosenAgent);
$("semantics").addEventListener("change", chosenAgent);
$("pause").addEventListener("click", toggle);
$("step").addEventListener("click", () => send({do: "step"}));
$("speed").addEventListener("change", () => send({do: "speed", per_s: Number($("speed").value)}));
$("take").addEventListener("click", take);
$("hints").addEventListener("click", hints);
$("run-filter").addEventListener("input", showRuns);
$("compare").addEventListener("click", compare);
$("outcome-filter").addEventListener("change", showEpisodes);
$("place").addEventListener("input", drawHouse);
$("place").addEventListener("focus", showAbove);
$("above-picture").addEventListener("pointerdown", press);
$("above-picture").addEventListener("pointermove", aim);
for (const end of ["pointerup", "pointercancel"]) $("above-picture").addEventListener(end, () => { pressed = null; });
$("replay-episode").addEventListener("change", chooseReplay);
$("replay-play").addEventListener("click", playReplay);
$("replay-at").addEventListener("input", scrub);
for (const video of replayed) video.addEventListener("loadedmetadata", showTime);
$("run-delete").addEventListener("click", deleteRun);
$("end").addEventListener("click", () => send({do: "stop"}));
$("tab-live").addEventListener("click", () => tab("live"));
$("tab-runs").addEventListener("click", () => tab("runs"));
document.querySelectorAll(".pad button").forEach(hold);
for (const figure of figures.values()) {
  figure.addEventListener("click", () => {
    if (phone.matches) {
      $("stage").prepend(figure);
      return;
    }
    const enlarge = !figure.classList.contains("large");
    for (const other of figures.values()) other.classList.toggle("large", enlarge && other === figure);
    $("stage").classList.toggle("enlarged", enlarge);
  });
}
choose().then(connect);
