/* Draws the plots of a report and plays its animation. Nothing is fetched. */
(async () => {
  const { MARGIN, OPTIONS, byId, clock, bytes, unpacked, tell, told, traces, layout, hasWebGL, follower, drawNames, sceneFrom, loadPlotly } = viewer;

  /* ---- plots ---- */

  /* The dashed line of the clock over a plot, and the time at a click. */
  function link(wrapper, drawn) {
    const cursor = document.createElement("div");
    cursor.className = "cursor";
    wrapper.append(cursor);
    const place = (t) => {
      const [first, last] = drawn.layout.xaxis.range;
      const part = (t - first) / (last - first);
      const width = wrapper.clientWidth - MARGIN.l - MARGIN.r;
      cursor.style.display = part >= 0 && part <= 1 ? "block" : "none";
      cursor.style.left = `${MARGIN.l + part * width}px`;
    };
    clock.followers.push(place);
    drawn.on("plotly_relayout", () => place(clock.t));
    drawn.on("plotly_click", (event) => clock.set(event.points[0].x));
  }

  /* All plots show the same time. */
  function zoomTogether(all, range) {
    let busy = false;
    for (const drawn of all) {
      drawn.on("plotly_relayout", async (change) => {
        const moved = Object.keys(change).some((key) => key.startsWith("xaxis."));
        if (busy || !moved) return;
        busy = true;
        const shown = change["xaxis.autorange"] ? range : drawn.layout.xaxis.range;
        await Promise.all(all.map((other) => Plotly.relayout(other, { "xaxis.range": shown.slice(), "xaxis.autorange": false })));
        busy = false;
      });
    }
  }

  async function drawPlots(data) {
    const places = [...document.querySelectorAll(".plot")];
    if (!places.length) return;
    await loadPlotly();
    const all = [];
    for (const wrapper of places) {
      const plot = data.plots[Number(wrapper.dataset.plot)];
      const drawn = wrapper.querySelector(".drawn");
      await Plotly.newPlot(drawn, traces(plot), layout(plot, data.range), OPTIONS);
      if (data.moves) link(wrapper, drawn);
      all.push(drawn);
    }
    zoomTogether(all, data.range);
    window.addEventListener("beforeprint", () => all.forEach((d) => Plotly.relayout(d, { width: 680 })));
    window.addEventListener("afterprint", () => all.forEach((d) => Plotly.relayout(d, { width: null, autosize: true })));
  }

  /* ---- animation ---- */

  function connect(scene, data) {
    const [first, last] = data.range;
    const play = byId("play");
    const when = byId("when");
    let since = null;
    const step = (now) => {
      if (since === null) return;
      const part = (Math.max(now - since, 0) / 1000 / data.duration) * Number(byId("speed").value);
      since = now;
      const t = clock.t + part * (last - first);
      clock.set(t > last ? first : t);
      requestAnimationFrame(step);
    };
    const run = (runs) => {
      since = runs ? performance.now() : null;
      play.textContent = runs ? "❚❚ Pause" : "▶ Play";
      if (runs) requestAnimationFrame(step);
    };
    clock.followers.push(follower(scene, data.instants), (t) => {
      when.value = String(t);
      byId("clock").textContent = told(t);
    });
    when.min = first;
    when.max = last;
    when.step = (last - first) / 10000 || 1;
    when.addEventListener("input", () => clock.set(Number(when.value)));
    play.addEventListener("click", () => run(since === null));
    byId("names").addEventListener("change", (event) => byId("names-of-marks").classList.toggle("unseen", !event.target.checked));
    for (const view of document.querySelectorAll("[data-camera]"))
      view.addEventListener("click", () => scene.setCamera(JSON.parse(view.dataset.camera)));
  }

  async function drawMotion(data) {
    const stage = byId("stage");
    if (!stage) return;
    const still = byId("still");
    if (!hasWebGL()) {
      ["controls", "canvas", "names-of-marks"].forEach((id) => byId(id)?.remove());
      stage.style.height = "auto";
      document.querySelectorAll(".moving").forEach((remark) => remark.remove());
      const missing = document.createElement("div");
      tell(missing, "This browser has no WebGL: a picture stands in place of the animation.");
      stage.prepend(missing);
      return;
    }
    still.classList.add("unseen");
    const scene = await sceneFrom(await unpacked("k3d"), bytes("scene").buffer, byId("canvas"));
    connect(scene, data);
    drawNames(scene, data);
    window.duhamel = { scene, clock };
  }

  try {
    const data = JSON.parse(await unpacked("data"));
    await drawPlots(data);
    await drawMotion(data);
    if (data.moves) clock.set(data.range[0]);
    document.documentElement.dataset.ready = "yes";
  } catch (error) {
    console.error(error);
    const place = document.createElement("div");
    tell(place, `Plots and animation cannot be drawn by this browser: ${error}. The tables are whole.`);
    document.querySelector("main").prepend(place);
    document.documentElement.dataset.ready = "failed";
  }
})();
