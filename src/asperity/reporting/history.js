"use strict";
// The contact force of a whole run: zoomed by dragging, buttons or keys, and read by a cursor.
// Where a browser lacks what it takes, the drawing that stands in the page stays.
(async () => {
  const source = document.getElementById("history-data");
  if (!source || typeof DecompressionStream === "undefined") return;
  const run = JSON.parse(source.textContent);
  const laws = run.laws, main = laws[0];

  async function unpacked() {
    const bytes = Uint8Array.from(atob(run.data), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    const plain = new Uint8Array(await new Response(stream).arrayBuffer());
    return laws.map((law, row) => {
      const low = plain.subarray(2 * row * run.points), high = low.subarray(run.points);
      const force = new Float64Array(run.points);
      for (let i = 0, change = 0, level = 0; i < run.points; i++) {
        change += ((low[i] | (high[i] << 8)) << 16) >> 16;
        level += change;
        force[i] = law.lowest + law.step * level;
      }
      return force;
    });
  }

  const forces = await unpacked();
  const times = Float64Array.from({ length: run.points }, (_, i) => run.start + run.pitch * i);
  const last = times[run.points - 1];
  const figure = source.closest("figure"), root = document.documentElement;
  const colour = (name) => getComputedStyle(root).getPropertyValue(name).trim();

  const backwards = (items) => [...items].reverse();  // the main law is the first, and drawn last: on top
  const make = (tag, properties, parent) => {
    const made = Object.assign(document.createElement(tag), properties);
    parent.append(made);
    return made;
  };
  const live = make("div", { className: "live" }, figure);
  figure.insertBefore(live, figure.querySelector(".drawing"));
  const tools = make("div", { className: "tools" }, live);
  const curves = make("div", { className: "curves" }, live);
  curves.setAttribute("role", "group");
  curves.setAttribute("aria-label", "Laws that are drawn");
  const area = make("div", { className: "plot", tabIndex: 0 }, live);
  area.setAttribute("role", "application");
  area.setAttribute("aria-label", "Contact force over time. Arrow keys move the cursor, page keys move it " +
    "farther, plus and minus zoom, with shift the arrows shift what is seen, 0 shows the whole run.");
  const reading = make("p", { className: "reading note" }, live);
  reading.setAttribute("role", "status");
  const hint = "Drag over the figure to zoom, double-click to see all again; or click into it and use arrows, + and −.";
  reading.textContent = hint;

  const outputs = laws.map((law, row) => {
    const label = make("label", {}, curves);
    const box = make("input", { type: "checkbox", checked: law.shown }, label);
    box.addEventListener("change", () => {
      law.shown = box.checked;
      plot.setSeries(laws.length - row, { show: law.shown });
    });
    const swatch = make("span", { className: "swatch" }, label), dashes = law.dashes.map((length) => 2 * length).join(" ");
    swatch.innerHTML = `<svg viewBox="0 0 26 6" aria-hidden="true"><path d="M0 3h26" stroke-width="2.4"/></svg>`;
    swatch.querySelector("path").style.cssText = `stroke: var(${law.colour}); stroke-dasharray: ${dashes || "none"}`;
    make("span", { textContent: law.name + (law.main && laws.length > 1 ? " (main)" : "") }, label);
    return make("span", { className: "value" }, label);
  });

  const lossTime = (step) => run.start + run.interval * step;
  const size = main.lowest + 16383 * main.step;  // the largest force of the main law
  const places = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(Math.max(Math.abs(size), 1e-9)))));
  const digits = (number) => number.toFixed(places).replace(/^-(?=.*[1-9])/, "−").replace(/^-/, "");
  const written = (time) => time.toFixed(Math.max(0, -Math.floor(Math.log10(run.interval)) + 1));

  function markLosses(plot) {  // shaded: of the main law; bars along the bottom: of every law that is drawn
    const { ctx, bbox } = plot, ratio = devicePixelRatio || 1;
    let row = 0;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    for (const law of laws) {
      if (!law.shown || !law.losses.length) continue;
      ctx.fillStyle = colour(law.colour);
      const bottom = bbox.top + bbox.height - (4 + 6 * row++) * ratio;
      for (const [first, end] of law.losses) {
        const from = plot.valToPos(lossTime(first), "x", true), to = plot.valToPos(lossTime(end + 1), "x", true);
        if (to < bbox.left || from > bbox.left + bbox.width) continue;
        const width = Math.max(to - from, ratio);
        ctx.fillRect(from, bottom, width, 4 * ratio);
        if (law === main) {
          ctx.globalAlpha = 0.13;
          ctx.fillRect(from, bbox.top, width, bbox.height);
          ctx.globalAlpha = 1;
        }
      }
    }
    ctx.restore();
  }

  function forceRange(plot, low, high) {
    if (low == null) return [0, 1];
    const span = high - low || 1;
    if (low > 0 && low < span) low = 0;  // zero, where contact is lost, if it is near
    const rows = laws.filter((law) => law.shown && law.losses.length).length;
    return [low - span * (0.04 + (rows ? 0.03 + 0.022 * rows : 0)), high + 0.04 * span];
  }

  function values(index) {
    laws.forEach((law, row) => {
      outputs[row].textContent = index == null ? "" : ` ${digits(forces[row][index])} ${run.force}`;
    });
  }

  let plot, at = null;
  function draw(range) {
    if (plot) plot.destroy();
    const ink = colour("--c0"), rule = colour("--c2"), axis = { stroke: ink, grid: { stroke: rule, width: 1 },
      ticks: { stroke: rule, width: 1 }, font: "12px system-ui, sans-serif", labelFont: "12px system-ui, sans-serif",
      labelSize: 18 };
    const narrow = area.clientWidth < 560;
    plot = new uPlot({
      width: area.clientWidth, height: narrow ? 270 : 360,
      legend: { show: false },
      cursor: { drag: { x: true, y: false, setScale: true }, points: { size: 6 }, focus: { prox: -1 } },
      scales: { x: { time: false, min: range[0], max: range[1] }, y: { range: forceRange } },
      axes: [
        { ...axis, label: `time / ${run.time}`, size: 34, space: narrow ? 50 : 70 },
        { ...axis, label: `contact force / ${run.force}`, size: 58 },
      ],
      series: [{}, ...backwards(laws).map((law) => ({
        label: law.name, show: law.shown, stroke: colour(law.colour), dash: law.dashes.map((length) => 1.6 * length),
        width: law.main ? 2 : 1.2, points: { show: false },
      }))],
      hooks: {
        drawAxes: [markLosses],
        setScale: [(drawn, key) => { if (key === "x") span = [drawn.scales.x.min, drawn.scales.x.max]; }],
      },
    }, [times, ...backwards(forces)], area);
    plot.over.addEventListener("mousemove", (event) => {
      at = plot.posToIdx(event.clientX - plot.over.getBoundingClientRect().left);
      values(at);
    });
    place();
  }

  let span = [times[0], last];  // what is seen; the scale itself follows a moment later
  const seen = () => span;
  function show(from, to) {
    const least = 8 * run.pitch;
    const length = Math.min(Math.max(to - from, least), last - times[0]);
    from = Math.min(Math.max(from, times[0]), last - length);
    span = [from, from + length];
    plot.setScale("x", { min: span[0], max: span[1] });
    place();
  }
  function place() {  // the cursor, where the scale will have moved it
    queueMicrotask(() => {
      if (at == null) return;
      const left = plot.valToPos(times[at], "x"), inside = left >= 0 && left <= plot.over.clientWidth;
      plot.setCursor(inside ? { left, top: plot.valToPos(forces[0][at], "y") } : { left: -10, top: -10 });
    });
  }
  function point(index) {
    at = Math.min(Math.max(index, 0), run.points - 1);
    const [from, to] = seen();
    if (times[at] < from || times[at] > to) show(times[at] - (to - from) / 2, times[at] + (to - from) / 2);
    place();
    values(at);
    const told = laws.map((law, row) => (law.shown ? `${law.name} ${digits(forces[row][at])} ${run.force}` : ""));
    const without = laws.filter((law) => law.shown && law.losses.some(([first, end]) =>
      lossTime(first) <= times[at] && times[at] <= lossTime(end))).map((law) => law.name);
    reading.textContent = `${written(times[at])} ${run.time}: ${told.filter(Boolean).join(", ")}` +
      (without.length ? `; no contact: ${without.join(", ")}` : "");
  }
  function zoom(factor) {
    const [from, to] = seen();
    const middle = at != null && times[at] >= from && times[at] <= to ? times[at] : (from + to) / 2;
    show(middle - (middle - from) * factor, middle + (to - middle) * factor);
  }
  function shift(share) {
    const [from, to] = seen();
    show(from + share * (to - from), to + share * (to - from));
  }
  function around(time, index) {
    const length = Math.max((last - times[0]) / 50, 40 * run.pitch);
    show(time - length / 2, time + length / 2);
    point(index);
  }
  function nextLoss() {
    const now = at == null ? -Infinity : times[at];
    const [first, end] = main.losses.find(([start]) => lossTime(start) > now) || main.losses[0];
    const middle = lossTime((first + end) / 2), length = 6 * (lossTime(end) - lossTime(first)) + 40 * run.interval;
    show(middle - length / 2, middle + length / 2);
    point(Math.ceil((lossTime(first) - times[0]) / (run.pitch) + 1e-6));
  }
  const largest = () => {
    let index = 0;
    forces[0].forEach((force, i) => { if (force > forces[0][index]) index = i; });
    around(times[index], index);
  };

  const buttons = [
    ["whole run", () => show(times[0], last)],
    ["zoom in", () => zoom(0.5)],
    ["zoom out", () => zoom(2)],
    ["earlier", () => shift(-0.5)],
    ["later", () => shift(0.5)],
    ["largest force", largest],
  ];
  if (main.losses.length) buttons.push(["next loss of contact", nextLoss]);
  for (const [name, act] of buttons) {
    make("button", { type: "button", textContent: name }, tools).addEventListener("click", act);
  }

  area.addEventListener("keydown", (event) => {
    const [from, to] = seen(), pixels = plot.over.clientWidth || 1;
    const step = Math.max(1, Math.round((to - from) / pixels / (run.pitch)));
    const here = at ?? Math.round(((from + to) / 2 - times[0]) / (run.pitch));
    const keys = {
      ArrowLeft: () => (event.shiftKey ? shift(-0.2) : point(here - step)),
      ArrowRight: () => (event.shiftKey ? shift(0.2) : point(here + step)),
      PageDown: () => point(here + 40 * step), PageUp: () => point(here - 40 * step),
      Home: () => point(0), End: () => point(run.points - 1),
      "+": () => zoom(0.5), "=": () => zoom(0.5), "-": () => zoom(2), 0: () => show(times[0], last),
    };
    if (!keys[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  figure.classList.add("ready");
  draw([times[0], last]);
  let width = area.clientWidth;
  new ResizeObserver(() => {
    if (area.clientWidth && area.clientWidth !== width) { width = area.clientWidth; draw(seen()); }
  }).observe(area);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => draw(seen()));
})();

// Paper shows what is folded.
addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((folded) => { folded.open = true; }));
