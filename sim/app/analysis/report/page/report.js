"use strict";
// The table (sort, filter, expand) and the pictures of the episodes. Text is only set as textContent.
(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const table = document.getElementById("table");
  const body = table.tBodies[0];
  const rows = [...body.rows];
  const filters = document.getElementById("filters");
  const ACTIONS = ["STOP", "forward", "turn left", "turn right", "look up", "look down"];
  const PIECES = 14;
  let sorted = { column: -1, down: false };

  function element(namespace, name, attributes, children) {
    const made = document.createElementNS(namespace, name);
    for (const [key, value] of Object.entries(attributes || {})) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }
  const svg = (name, attributes, ...children) => element("http://www.w3.org/2000/svg", name, attributes, children);
  const html = (name, attributes, ...children) => element("http://www.w3.org/1999/xhtml", name, attributes, children);
  const plain = (name) => (name === "tv_monitor" ? "television" : name.replaceAll("_", " "));

  // ---- the table
  function value(row, column) {
    const cell = row.cells[column];
    if (cell.dataset.v === undefined) return cell.textContent.trim().toLowerCase();
    return cell.dataset.v === "" ? null : Number(cell.dataset.v);
  }

  function compare(a, b) {
    if (a === null || b === null) return (a === null) - (b === null);
    return typeof a === "number" ? a - b : a.localeCompare(b, "en", { numeric: true });
  }

  function sort(column, down) {
    sorted = { column, down };
    const keyed = rows.map((row) => [value(row, column), row]);
    keyed.sort(([a, rowA], [b, rowB]) => {
      const order = compare(a, b);
      const known = a !== null && b !== null;  // rows without a value stay at the end in both orders
      return (down && known ? -order : order) || rowA.dataset.index - rowB.dataset.index;
    });
    const fragment = document.createDocumentFragment();
    for (const [, row] of keyed) {
      const detail = detailOf(row);
      fragment.append(row, ...(detail ? [detail] : []));
    }
    body.append(fragment);
    [...table.tHead.rows[0].cells].forEach((cell, i) =>
      cell.setAttribute("aria-sort", i !== column ? "none" : down ? "descending" : "ascending"));
    filters.elements.sort.value = String(column);
  }

  function fits(row, wanted) {
    const { goal, house, outcome, collisions } = row.dataset;
    const words = `${row.cells[0].textContent} ${row.cells[1].textContent} ${house} ${plain(outcome)}`.toLowerCase();
    return (!wanted.goal || goal.split("|").includes(wanted.goal)) && (!wanted.house || wanted.house === house)
      && (!wanted.outcome || outcome.split(" ").includes(wanted.outcome))
      && (!wanted.collided || Number(collisions) > 0)
      && wanted.words.every((word) => words.includes(word));
  }

  function filter() {
    const form = filters.elements;
    const wanted = {
      goal: form.goal.value, house: form.house.value, outcome: form.outcome.value, collided: form.collided.checked,
      words: plain(form.text.value).toLowerCase().split(/\s+/).filter(Boolean),
    };
    let shown = 0;
    for (const row of rows) {
      row.hidden = !fits(row, wanted);
      const detail = detailOf(row);
      if (detail) detail.hidden = row.hidden;
      shown += !row.hidden;
    }
    document.getElementById("count").textContent = `${shown} of ${rows.length} episodes`;
    document.getElementById("none").hidden = shown > 0;
  }

  function detailOf(row) {
    const next = row.nextElementSibling;
    return next && next.classList.contains("detail") && next.dataset.of === row.dataset.index ? next : null;
  }

  function toggle(row, open = !detailOf(row)) {
    const detail = detailOf(row);
    if (open === Boolean(detail)) return;
    if (detail) detail.remove();
    else row.after(makeDetail(row));
    row.querySelector(".open").setAttribute("aria-expanded", String(open));
    const id = data.episodes[row.dataset.index].id;
    if (open) history.replaceState(null, "", `#episode=${encodeURIComponent(id)}`);
  }

  // ---- thumbnails
  function thumbnail(episode, run) {
    const address = `data:image/jpeg;base64,${episode.thumbs[run]}`;
    return html("img", { class: "thumb", loading: "lazy", decoding: "async", alt: "", width: 68, height: 51, src: address });
  }

  function addThumbnails() {
    for (const row of rows) {
      const episode = data.episodes[row.dataset.index];
      for (const outcome of row.querySelectorAll(".outcome")) {
        if (episode.thumbs[outcome.dataset.run]) outcome.prepend(thumbnail(episode, outcome.dataset.run));
      }
    }
  }

  // ---- the picture of the end and the video: files of the run, found from where the page lies
  function makePhoto(episode, run) {
    if (!episode.pictures[run]) return [];
    const words = html("figcaption", {}, "What the camera sees at the end, without noise.");
    const image = html("img", { src: episode.pictures[run], alt: `What the camera sees at the end of ${episode.id}` });
    image.addEventListener("error", () => {
      if (episode.thumbs[run]) image.replaceWith(thumbnail(episode, run));
      words.textContent = "The large picture does not exist: keep the page next to the folder of its run.";
    }, { once: true });
    return [html("figure", {}, image, words)];
  }

  function makeVideo(episode, run) {
    if (!episode.videos[run]) return [];
    const src = episode.videos[run];
    // The browser shows the first frame; the picture of the end is next to it.
    const player = html("video", { controls: "", preload: "metadata", src, "aria-label": `Video of ${episode.id}` });
    const words = html("figcaption", {}, html("a", { href: src }, "Open the file of the video"));
    player.addEventListener("error", () => {
      player.remove();
      words.textContent = "The video does not exist: keep the page next to the folder of its run.";
    }, { once: true });
    return [html("figure", { class: "film" }, player, words)];
  }

  // ---- the pictures
  function makeDetail(row) {
    const episode = data.episodes[row.dataset.index];
    const sides = html("div", { class: "sides" });
    data.runs.forEach((label, run) => sides.append(makeSide(episode, run, label)));
    const cell = html("td", { colspan: row.cells.length }, html("div", {}, makeNumbers(row), sides));
    return html("tr", { class: "detail", "data-of": row.dataset.index }, cell);
  }

  // The values of the columns that a narrow window hides.
  function makeNumbers(row) {
    const numbers = html("p", { class: "facts only-narrow" });
    [...table.tHead.rows[0].cells].forEach((head, i) => {
      if (!head.classList.contains("second")) return;
      const key = html("span", { class: "key" }, head.textContent);
      numbers.append(html("span", {}, key, ` ${row.cells[i].textContent}`));
    });
    return numbers;
  }

  function makeSide(episode, run, label) {
    const side = html("div", { class: "path" });
    if (label) side.append(html("h3", {}, html("span", { class: "badge" }, label), ` ${plain(episode.outcomes[run])}`));
    const why = html("p", { class: "why" }, episode.words[run]);
    const facts = label ? [html("p", { class: "small" }, episode.facts[run].join("; "))] : [];
    const photo = makePhoto(episode, run), film = makeVideo(episode, run);
    const path = episode.paths && episode.paths[run] ? decode(episode.paths[run]) : null;
    if (!path) {
      side.append(html("div", {}, why, ...facts, html("p", { class: "small" }, data.why_no_picture), ...photo), ...film);
      return side;
    }
    const picture = makePicture(episode, path);
    const chart = makeChart(path);
    const status = html("output", {});
    const slider = html("input", { type: "range", min: 0, max: path.n, value: path.n, "aria-label": "Step of the episode" });
    const show = (step) => {
      slider.value = step;
      picture.show(step);
      chart.show(step);
      status.textContent = describeStep(path, step);
    };
    slider.addEventListener("input", () => show(Number(slider.value)));
    const marks = html("ol", { class: "marks" });
    path.marks.forEach(([, step, until, words], i) => {
      const span = until === null ? `step ${step}` : `steps ${step} to ${until}`;
      const button = html("button", { type: "button", class: "link" }, `${i + 1}. ${span}: ${words}`);
      button.addEventListener("click", () => show(until === null ? step : until));
      marks.append(html("li", {}, button));
    });
    const scrub = html("div", { class: "scrub" }, chart.svg, slider, status);
    side.append(html("div", {}, picture.svg, makeLegend(episode, path)), html("div", {}, why, ...facts, marks, scrub, ...photo), ...film);
    show(path.n);
    return side;
  }

  function decode(path) {
    const sum = (steps) => { let total = 0; return steps.map((step) => (total += step)); };
    const x = sum(path.x), y = sum(path.y);
    return { ...path, x, y, a: sum(path.a), n: path.actions.length, stops: new Set(path.stopped) };
  }

  function describeStep(path, step) {
    const parts = [`Step ${step} of ${path.n}`];
    if (step > 0) {
      const hit = path.stops.has(step - 1) ? ", stopped by a contact" : "";
      parts.push(`${ACTIONS[path.actions[step - 1]]}${hit}`);
    }
    parts.push(path.d[step] === null ? "no path to the goal" : `${(path.d[step] / 10).toFixed(1)} m to go`);
    if (path.seen.some(([first, last]) => step >= first && step <= last)) parts.push("goal in view");
    return `${parts.join("; ")}.`;
  }

  const points = (path, from, to) => {
    const found = [];
    for (let i = from; i <= to; i++) found.push(`${path.x[i]},${path.y[i]}`);
    return found.join(" ");
  };

  function makePicture(episode, path) {
    const plan = data.plans[episode.plan];
    const [width, height] = plan ? plan.size : episode.size;
    const unit = Math.max(width, height) / Math.min(100, Math.max(55, innerWidth / 7));  // of text and symbols
    const name = `Plan of the house with the path of the robot in ${episode.id}`;
    const picture = svg("svg", { class: "plan", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": name });
    if (plan) drawPlan(picture, plan, episode, unit);
    if (episode.shortest && episode.shortest.length) {
      picture.append(svg("polyline", { class: "shortest", points: episode.shortest.join(" ") }));
    }
    for (const [kind, step, until] of path.marks) {
      if (until !== null) picture.append(svg("polyline", { class: `wrong ${kind}`, points: points(path, step, until) }));
    }
    const trail = drawTrail(picture, path);
    for (const [step, x, y] of path.hits) drawHit(picture, x, y, unit, `stopped by a contact in step ${step + 1}`);
    picture.append(svg("circle", { class: "start", cx: path.x[0], cy: path.y[0], r: 1.1 * unit }));
    drawMarks(picture, path, unit);
    const nose = svg("path", { d: `M0 0H${path.robot}` });
    const robot = svg("g", { class: "robot" }, svg("circle", { r: path.robot }), nose);
    picture.append(robot);
    const show = (step) => {
      robot.setAttribute("transform", `translate(${path.x[step]} ${path.y[step]}) rotate(${path.a[step]})`);
      trail(step);
    };
    return { svg: picture, show };
  }

  function drawPlan(picture, plan, episode, unit) {
    for (const [x, y, width, height] of plan.floor) picture.append(svg("rect", { class: "floor", x, y, width, height }));
    const late = [];
    for (const [category, name, d] of plan.shapes) {
      const structure = ["wall", "door", "window", "column"].includes(category);
      const goal = category === episode.goal;
      const shape = svg("path", { class: goal ? "goal" : structure ? category : "object", d });
      shape.append(svg("title", {}, plain(name)));
      if (goal) late.push(shape);
      else picture.append(shape);
    }
    if (data.areas[episode.area]) picture.append(svg("path", { class: "area", d: data.areas[episode.area] }));
    picture.append(...late);
    for (const [name, x, y, width] of plan.rooms) {
      const size = Math.min(2.1 * unit, (1.75 * width) / name.length);
      picture.append(svg("text", { class: "room", x, y, "font-size": size }, name));
    }
  }

  function drawTrail(picture, path) {
    const pieces = Array.from({ length: PIECES }, (_, i) => {
      const share = `${(100 * (i + 0.5)) / PIECES}%`;
      const colour = `color-mix(in oklab, rgb(var(--path-end)) ${share}, rgb(var(--path-begin)))`;
      return svg("polyline", { class: "trail", style: `stroke:${colour}` });
    });
    picture.append(...pieces);
    return (step) => pieces.forEach((piece, i) => {
      const from = Math.floor((path.n * i) / PIECES), to = Math.min(step, Math.floor((path.n * (i + 1)) / PIECES));
      piece.setAttribute("points", to > from ? points(path, from, to) : "");
    });
  }

  function drawHit(picture, x, y, unit, words) {
    const r = 0.8 * unit;
    const d = `M${x - r} ${y - r}l${2 * r} ${2 * r}m0 ${-2 * r}l${-2 * r} ${2 * r}`;
    picture.append(svg("path", { class: "hit", d }, svg("title", {}, words)));
  }

  function drawMarks(picture, path, unit) {
    const taken = [];
    path.marks.forEach(([kind, step, , words], i) => {
      let x = path.x[step], y = path.y[step] - 2.6 * unit;
      while (taken.some(([u, v]) => Math.hypot(u - x, v - y) < 3.2 * unit)) x += 3.3 * unit;
      taken.push([x, y]);
      const label = svg("text", { x, y: y + 0.75 * unit, "font-size": 2.1 * unit }, String(i + 1));
      const title = svg("title", {}, words);
      picture.append(svg("g", { class: `mark ${kind}` }, svg("circle", { cx: x, cy: y, r: 1.55 * unit }), label, title));
    });
  }

  function makeLegend(episode, path) {
    const legend = html("ul", { class: "legend" });
    const add = (words, ...shapes) => {
      const swatch = svg("svg", { viewBox: "0 0 22 12", "aria-hidden": "true" }, ...shapes);
      legend.append(html("li", {}, swatch, words));
    };
    const line = (attributes) => svg("path", { d: "M1 6H21", ...attributes });
    const late = line({ class: "trail", style: "stroke:rgb(var(--path-end))", d: "M11 6H21" });
    add("path of the robot, early to late", line({ class: "trail", style: "stroke:rgb(var(--path-begin))", d: "M1 6H11" }), late);
    if (episode.shortest && episode.shortest.length) add("shortest path", line({ class: "shortest" }));
    if (path.hits.length) add("collision", svg("path", { class: "hit", d: "M7 2l8 8m0 -8l-8 8" }));
    if (path.marks.some(([, , until]) => until !== null)) add("loop or trapped", line({ class: "wrong" }));
    if (episode.plan) add(plain(episode.goal), svg("rect", { class: "goal", x: 4, y: 1, width: 14, height: 10 }));
    if (data.areas[episode.area]) add("a STOP succeeds", svg("rect", { class: "area", x: 4, y: 1, width: 14, height: 10 }));
    add("start", svg("circle", { class: "start", cx: 11, cy: 6, r: 4 }));
    return legend;
  }

  function niceTop(value) {
    const unit = 10 ** Math.floor(Math.log10(value));
    return [1, 2, 4, 6, 8, 10].find((n) => n * unit >= value) * unit;
  }

  function makeChart(path) {
    const top = niceTop(Math.max(1, ...path.d.filter((d) => d !== null).map((d) => d / 10)));
    const x = (step) => 34 + (438 * step) / Math.max(1, path.n), y = (metres) => 98 - (84 * metres) / top;
    const words = `Distance to the goal over ${path.n} steps, up to ${top} m`;
    const chart = svg("svg", { class: "chart", viewBox: "0 0 480 126", role: "img", "aria-label": words });
    chart.append(svg("title", {}, words), svg("rect", { class: "box", x: 34, y: 14, width: 438, height: 84 }));
    for (const [first, last] of path.seen) {
      chart.append(svg("rect", { class: "in-view", x: x(first), y: 14, width: Math.min(472, x(last + 1)) - x(first), height: 84 }));
    }
    for (const part of [0, 0.5, 1]) {
      chart.append(svg("path", { class: "grid", d: `M34 ${y(part * top)}H472` }), svg("text", { class: "end", x: 30, y: y(part * top) + 3 }, `${part * top}`));
    }
    for (const step of [0, Math.round(path.n / 2), path.n]) {
      chart.append(svg("text", { class: step === path.n ? "end" : "mid", x: x(step), y: 110 }, `${step}`));
    }
    chart.append(svg("text", { x: 34, y: 10 }, "m to the goal"), svg("text", { class: "mid", x: 253, y: 123 }, "step"));
    for (const step of path.stopped) chart.append(svg("path", { class: "tick", d: `M${x(step + 1)} 98v-10` }));
    let piece = [];
    const flush = () => {
      if (piece.length > 1) chart.append(svg("polyline", { points: piece.join(" ") }));
      piece = [];
    };
    path.d.forEach((d, step) => (d === null ? flush() : piece.push(`${x(step)},${y(d / 10)}`)));
    flush();
    const now = svg("path", { class: "now" });
    chart.append(now);
    return { svg: chart, show: (step) => now.setAttribute("d", `M${x(step)} 14V98`) };
  }

  // ---- events
  table.tHead.addEventListener("click", (event) => {
    const button = event.target.closest("button");
    if (!button) return;
    const column = Number(button.dataset.column);
    sort(column, sorted.column === column && !sorted.down);
  });
  body.addEventListener("click", (event) => {
    const row = event.target.closest("tr[data-index]");
    if (row && !event.target.closest("a") && !String(getSelection())) toggle(row);
  });
  filters.addEventListener("input", (event) => {
    if (event.target.name === "sort") sort(Number(event.target.value), false);
    else filter();
  });
  filters.addEventListener("reset", () => setTimeout(filter));
  filters.addEventListener("submit", (event) => event.preventDefault());
  document.addEventListener("click", (event) => {
    const button = event.target.closest("[data-filter]");
    if (!button) return;
    filters.reset();
    filters.elements[button.dataset.filter].value = button.dataset.value;
    setTimeout(() => {
      filter();
      document.getElementById("episodes").scrollIntoView();
      filters.elements[button.dataset.filter].focus({ preventScroll: true });
    });
  });

  function followHash() {
    const wanted = new URLSearchParams(location.hash.slice(1)).get("episode");
    const row = wanted && rows.find((row) => data.episodes[row.dataset.index].id === wanted);
    if (!row) return;
    toggle(row, true);
    row.scrollIntoView();
  }
  addEventListener("hashchange", followHash);
  addThumbnails();
  filter();  // the browser may have restored the form
  followHash();
})();
