"use strict";
/* What pages share: programs and data that stand in them, compressed, plots, and a scene over time. */
const viewer = (() => {
  const byId = (id) => document.getElementById(id);
  const COLORS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];
  const MARGIN = { l: 74, r: 18, t: 30, b: 42 };
  /* Not those of the library, one of which sends a chart to a server. */
  const BUTTONS = [["zoom2d", "pan2d", "zoomIn2d", "zoomOut2d", "autoScale2d", "toImage"]];
  const OPTIONS = { displaylogo: false, responsive: true, modeBarButtons: BUTTONS };

  /* The time that animation and plots show [s], and who follows it. */
  const clock = {
    followers: [],
    t: 0,
    set(t) {
      this.t = t;
      this.followers.forEach((follow) => follow(t));
    },
  };

  function bytes(id) {
    const text = atob(byId(id).textContent.trim());
    const found = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) found[i] = text.charCodeAt(i);
    return found;
  }

  async function unpacked(id) {
    const stream = new Blob([bytes(id)]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  }

  function tell(place, text) {
    const told = document.createElement("p");
    told.className = "failed";
    told.textContent = text;
    place.replaceChildren(told);
  }

  function told(time) {
    return `${Number(time.toPrecision(5))} s`;
  }

  function traces(plot) {
    return plot.curves.map((curve, i) => ({
      x: curve.x,
      y: curve.y,
      name: curve.name,
      mode: plot.marks ? "markers" : "lines",
      line: { color: COLORS[i % COLORS.length], width: 1.5 },
      marker: { color: COLORS[i % COLORS.length], size: 7 },
      hovertemplate: "%{y:.5g} at %{x:.6g} s",
    }));
  }

  /* The colors of the page, which are others where it is dark. */
  function color(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  }

  function layout(plot, range) {
    const axis = { gridcolor: color("line"), zerolinecolor: color("line"), linecolor: color("soft"), ticks: "outside", tickcolor: color("line"), exponentformat: "power", automargin: false };
    return {
      margin: MARGIN,
      font: { family: "system-ui, sans-serif", size: 12, color: color("ink") },
      showlegend: true,
      legend: { orientation: "h", x: 0, xanchor: "left", y: 1.0, yanchor: "bottom", itemwidth: 30 },
      xaxis: { ...axis, title: { text: "time [s]", standoff: 6 }, range: range.slice() },
      yaxis: { ...axis, title: { text: plot.unit ? `[${plot.unit}]` : "", standoff: 4 }, type: plot.log ? "log" : "linear" },
      dragmode: "zoom",
      hovermode: "closest",
      paper_bgcolor: color("paper"),
      plot_bgcolor: color("paper"),
    };
  }

  function hasWebGL() {
    try {
      return Boolean(document.createElement("canvas").getContext("webgl2"));
    } catch {
      return false;
    }
  }

  /* The number of the instant at a time, with its fraction between two. */
  function frameAt(instants, t) {
    let low = 0;
    let high = instants.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (instants[middle] <= t) low = middle;
      else high = middle;
    }
    const span = instants[high] - instants[low];
    return span > 0 ? low + Math.min(Math.max((t - instants[low]) / span, 0), 1) : low;
  }

  /* A frame at a time: while one is drawn, the next waits. */
  function follower(scene, instants) {
    let busy = false;
    let next = null;
    return async (t) => {
      next = t;
      if (busy) return;
      busy = true;
      while (next !== null) {
        const shown = next;
        next = null;
        await scene.setTime(frameAt(instants, shown));
      }
      busy = false;
    };
  }

  /* Names of joints and others over the scene, as text that follows their places. */
  function drawNames(scene, data) {
    const stage = byId("names-of-marks");
    const { names, times, places } = data.marks;
    const shown = names.map((name) => {
      const label = document.createElement("span");
      label.textContent = name;
      stage.append(label);
      return label;
    });
    /* A name that would hide another is moved up or down, or left out; its dot stays. */
    const apart = (taken, width, height, x, y) => {
      for (const lift of [0, height, -height, 2 * height, -2 * height]) {
        const box = [x, y + lift, x + width, y + lift + height];
        if (taken.some(([l, t, r, b]) => box[0] < r && l < box[2] && box[1] < b && t < box[3])) continue;
        taken.push(box);
        return lift;
      }
      return null;
    };
    const sizes = shown.map((label) => [label.offsetWidth + 8, label.offsetHeight]);
    const place = () => {
      const taken = [];
      const { camera } = scene.getWorld();
      const toEye = camera.matrixWorldInverse.elements;
      const toScreen = camera.projectionMatrix.elements;
      const { clientWidth: width, clientHeight: height } = stage;
      const frame = frameAt(times, clock.t);
      const before = Math.floor(frame);
      const after = Math.ceil(frame);
      const part = frame - before;
      shown.forEach((label, i) => {
        const point = [0, 1, 2].map((axis) => places[before][3 * i + axis] * (1 - part) + places[after][3 * i + axis] * part);
        const seen = [0, 1, 2].map((row) => toEye[row] * point[0] + toEye[row + 4] * point[1] + toEye[row + 8] * point[2] + toEye[row + 12]);
        const depth = -seen[2];
        const x = (0.5 + (0.5 * toScreen[0] * seen[0]) / depth) * width;
        const y = (0.5 - (0.5 * toScreen[5] * seen[1]) / depth) * height;
        const lift = depth > 0 ? apart(taken, ...sizes[i], x, y) : null;
        label.style.display = depth > 0 ? "" : "none";
        label.classList.toggle("bare", lift === null);
        label.style.setProperty("--lift", `${lift ?? 0}px`);
        label.style.transform = `translate(${x}px, ${y + (lift ?? 0)}px)`;
      });
    };
    scene.on(scene.events.RENDERED, place);
    clock.followers.push(place);
  }

  /* A function, since the library defines itself as a module of AMD. */
  async function sceneFrom(program, snapshot, place) {
    let library;
    const define = (...given) => (library = given.at(-1)());
    new Function("define", program)(define);
    return library.CreateK3DAndLoadBinarySnapshot(snapshot, place);
  }

  async function loadPlotly() {
    const program = document.createElement("script");
    program.textContent = await unpacked("plotly");
    document.head.append(program);
  }

  return { MARGIN, OPTIONS, byId, clock, bytes, unpacked, tell, told, traces, layout, hasWebGL, frameAt, follower, drawNames, sceneFrom, loadPlotly };
})();
