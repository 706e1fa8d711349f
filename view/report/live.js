/* Follows a run: asks for what is new, moves the scene, draws the curves, and gives orders. */
(async () => {
  const { OPTIONS, byId, clock, bytes, unpacked, tell, told, traces, layout, hasWebGL, frameAt, drawNames, sceneFrom, loadPlotly } = viewer;
  /* Of instants that are kept for looking back: some 200 MB. */
  const MOST_NUMBERS = 5e7;
  /* Of the bodies from the middle of the stage, over half its height. */
  const LARGEST_OFFSET = 0.4;
  const token = location.pathname.split("/")[1];
  const quantities = [];
  let changed = false;
  let ordered = false;

  async function give(order) {
    await fetch(order, { method: "POST", headers: { "X-Duhamel": token } });
    ordered = true;
  }

  /* An answer of the program; where it gives none, it has ended, or the machine is very busy. */
  async function ask(address) {
    for (let silent = 0; ; silent++) {
      try {
        const answer = await fetch(address);
        if (!answer.ok) throw new Error(`${answer.status}`);
        return await answer.json();
      } catch (error) {
        if (silent === 3) throw new Error("The program has ended: this page shows what it knew last.");
        await waited(1, () => false);
      }
    }
  }

  async function waited(seconds, enough) {
    const end = performance.now() + 1000 * seconds;
    while (performance.now() < end && !enough()) await new Promise((resolve) => setTimeout(resolve, 50));
  }

  /* ---- motion ---- */

  function array(packed) {
    const text = atob(packed.data);
    const found = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) found[i] = text.charCodeAt(i);
    const [n, ...shape] = packed.shape;
    const all = new Float32Array(found.buffer);
    const size = all.length / n;
    return Array.from({ length: n }, (_, i) => ({ data: all.subarray(i * size, (i + 1) * size), shape }));
  }

  /* The parts of the scene over time, of which the oldest instants are forgotten. */
  class Motion {
    constructor(scene) {
      this.scene = scene;
      this.first = 0;
      this.instants = [];
      this.middles = [];
      this.marks = { names: [], times: [], places: [] };
      this.numbers = 0;
      const parts = Object.values(scene.getWorld().ObjectsListJson);
      this.parts = parts.filter((part) => /^\d+$/.test(part.name)).sort((a, b) => a.name - b.name);
    }

    take(news) {
      const from = this.first + this.instants.length;
      if (!news.instants.length) return;
      news.parts.forEach((part, i) => {
        const drawn = this.parts[i];
        for (const [key, packed] of [["model_matrix", part.matrices], ["vertices", part.vertices]]) {
          if (!packed) continue;
          /* The scene comes with its own numbers of instants. */
          if (from === 0 || !drawn[key]?.timeSeries) drawn[key] = { timeSeries: true };
          array(packed).forEach((value, k) => (drawn[key][from + k] = value));
          this.numbers += packed.shape.reduce((a, b) => a * b, 1);
        }
      });
      this.instants.push(...news.instants);
      this.middles.push(...news.middles);
      this.takeMarks(news.marks);
      this.forget();
    }

    /* Names that share a place at first share a label; where they part later, labels rest. */
    takeMarks({ names, times, places }) {
      if (!this.marks.times.length) this.marks.names = names;
      if (names.join() !== this.marks.names.join()) return;
      const last = this.marks.times.at(-1) ?? -Infinity;
      times.forEach((t, i) => {
        if (t <= last) return;
        this.marks.times.push(t);
        this.marks.places.push(places[i]);
      });
    }

    forget() {
      while (this.numbers > MOST_NUMBERS && this.instants.length > 2) {
        this.numbers -= this.numbers / this.instants.length;
        for (const part of this.parts) for (const key of ["model_matrix", "vertices"]) if (part[key]?.timeSeries) delete part[key][this.first];
        this.instants.shift();
        this.middles.shift();
        this.first += 1;
      }
    }

    async show(t) {
      if (!this.instants.length) return;
      const frame = frameAt(this.instants, t);
      if (byId("keep").checked) this.keepInView(this.middles[Math.round(frame)]);
      await this.scene.setTime(this.first + frame);
    }

    /* The camera moves with the middle of the bodies where that leaves the middle of the stage. */
    keepInView(middle) {
      const { camera, controls } = this.scene.getWorld();
      const target = controls.target.toArray();
      const way = middle.map((x, i) => x - target[i]);
      const off = Math.hypot(...way);
      const seen = camera.position.distanceTo(controls.target) * Math.tan((camera.fov * Math.PI) / 360);
      const part = 1 - (LARGEST_OFFSET * seen) / off;
      if (!(part > 0)) return;
      const moved = (point) => point.toArray().map((x, i) => x + part * way[i]);
      camera.position.fromArray(moved(camera.position));
      controls.target.fromArray(moved(controls.target));
      controls.update();
    }
  }

  function camerasOf(scene, cameras) {
    const place = byId("cameras");
    place.replaceChildren();
    for (const [name, camera] of Object.entries(cameras)) {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = name;
      button.addEventListener("click", () => scene.setCamera(camera));
      place.append(button);
    }
  }

  /* The clock runs to the newest instant, so that it is there when the next news come. */
  function play(motion, pace) {
    const when = byId("when");
    const follow = byId("follow");
    let before = performance.now();
    let busy = false;
    let shown = null;
    const step = async (now) => {
      const last = motion.instants.at(-1);
      if (follow.checked && clock.t < pace.from) clock.set(pace.from);
      if (follow.checked && last > clock.t) clock.set(Math.min(clock.t + ((now - before) / 1000) * pace.rate, last));
      before = now;
      requestAnimationFrame(step);
      /* To draw takes long on machines without a graphics card: not for nothing. */
      if (busy || shown === clock.t) return;
      busy = true;
      shown = clock.t;
      await motion.show(shown);
      busy = false;
    };
    clock.followers.push((t) => {
      when.value = String(t);
      byId("clock").textContent = told(t);
    });
    when.addEventListener("input", () => {
      follow.checked = false;
      clock.set(Number(when.value));
    });
    requestAnimationFrame(step);
  }

  /* ---- curves ---- */

  async function drawPlots(plots, range) {
    const place = byId("plots");
    while (place.children.length > plots.length) place.lastChild.remove();
    for (const [i, plot] of plots.entries()) {
      let figure = place.children[i];
      if (!figure) {
        figure = document.createElement("figure");
        figure.append(document.createElement("h3"), document.createElement("div"));
        figure.lastChild.className = "plot";
        place.append(figure);
      }
      figure.firstChild.textContent = plot.title;
      /* The revision keeps what the user has zoomed. */
      await Plotly.react(figure.lastChild, traces(plot), { ...layout(plot, range), uirevision: "kept" }, OPTIONS);
    }
  }

  /* ---- the run ---- */

  function showStatus(news, data) {
    const status = byId("status");
    const words = { running: "The run takes its steps.", held: "The run is paused.", finished: "The run has ended well.", stopped: "The run was stopped." };
    status.textContent = words[news.status] ?? news.status;
    status.className = `verdict ${news.over && news.status !== "finished" ? "poor" : news.status === "held" ? "fair" : "good"}`;
    byId("hold").textContent = news.status === "held" ? "▶ Continue the run" : "❚❚ Pause the run";
    byId("hold").dataset.order = news.status === "held" ? "go-on" : "hold";
    byId("hold").disabled = byId("stop").disabled = news.over;
    byId("progress").max = data.t_end;
  }

  async function main() {
    const data = JSON.parse(await unpacked("data"));
    await loadPlotly();
    let motion = null;
    const pace = { rate: 0, from: 0 };
    if (data.motion && hasWebGL()) {
      const scene = await sceneFrom(await unpacked("k3d"), bytes("scene").buffer, byId("canvas"));
      motion = new Motion(scene);
      motion.take(data.motion);
      camerasOf(scene, data.motion.cameras);
      drawNames(scene, motion);
      clock.t = motion.instants[0] ?? 0;
      play(motion, pace);
      window.duhamel = { scene, clock, motion };
    } else if (data.motion) tell(byId("stage"), "This browser has no WebGL: curves alone are shown.");
    byId("names").addEventListener("change", (event) => byId("names-of-marks").classList.toggle("unseen", !event.target.checked));
    byId("hold").addEventListener("click", (event) => give(event.target.dataset.order));
    byId("stop").addEventListener("click", () => give("stop"));
    byId("add").addEventListener("submit", (event) => {
      event.preventDefault();
      const quantity = byId("quantity").value.trim();
      if (quantity && !quantities.includes(quantity)) quantities.unshift(quantity);
      changed = true;
      byId("quantity").value = "";
    });
    let over = false;
    const curves = async () => {
      for (;;) {
        const told = await ask(`curves?${new URLSearchParams(quantities.map((q) => ["plot", q]))}`);
        if (told.plots) await drawPlots(told.plots, [0, data.t_end]);
        if (told.validity) byId("validity").innerHTML = told.validity;
        byId("refused").replaceChildren(...(told.refused ?? []).map((text) => Object.assign(document.createElement("p"), { className: "failed", textContent: text })));
        document.documentElement.dataset.ready = "yes";
        if (over) return;
        await waited(told.pause, () => over || changed);
        changed = false;
      }
    };
    const news = async () => {
      let first = data.rows;
      for (;;) {
        const told = await ask(`news?first=${first}`);
        showStatus(told, data);
        /* A page that was opened before the first row has no scene yet. */
        if (!data.motion && told.motion) return location.reload();
        first = told.rows;
        if (told.motion && motion) {
          motion.take(told.motion);
          camerasOf(motion.scene, told.motion.cameras);
          const last = motion.instants.at(-1);
          Object.assign(byId("when"), { min: motion.instants[0], max: last, step: (last - motion.instants[0]) / 10000 || 1 });
          pace.from = told.motion.instants[0] ?? last;
          pace.rate = Math.max(last - Math.max(clock.t, pace.from), 0) / (told.pause + 0.2);
          byId("progress").value = last;
          byId("reached").textContent = `${viewer.told(last)} of ${viewer.told(data.t_end)}`;
          const larger = told.motion.magnification;
          byId("magnified").textContent = larger === 1 ? "" : `Elastic deformations are drawn ${larger} times as large as they are.`;
        }
        over = told.over;
        /* Also when the run is over: as long as the page is open, the program answers. */
        await waited(over ? 2 : told.pause, () => ordered);
        ordered = false;
      }
    };
    await Promise.all([curves(), news()]);
  }

  try {
    await main();
  } catch (error) {
    byId("status").textContent += ` ${error.message}`;
    byId("hold").disabled = byId("stop").disabled = true;
    document.documentElement.dataset.ready ??= "failed";
  }
})();
