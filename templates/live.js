(async () => {
  const given = JSON.parse(document.getElementById("live-data").textContent);
  const ask = await liveCore(given.module);
  const controls = [
    ["vertical", "mass_kg_m", "mass m", "kg/m"], ["torsion", "inertia_kg_m2_m", "inertia J", "kg·m²/m"],
    ["vertical", "frequency_hz", "vertical frequency", "Hz"], ["vertical", "stiffness_n_m2", "vertical stiffness", "N/m²"],
    ["torsion", "frequency_hz", "torsional frequency", "Hz"], ["torsion", "stiffness_n", "torsional stiffness", "N"],
    ["vertical", "damping_ratio", "vertical damping ratio", "%"], ["torsion", "damping_ratio", "torsional damping ratio", "%"],
    ["lateral", "mass_kg_m", "lateral mass", "kg/m"], ["lateral", "frequency_hz", "lateral frequency", "Hz"],
    ["lateral", "stiffness_n_m2", "lateral stiffness", "N/m²"], ["lateral", "damping_ratio", "lateral damping ratio", "%"],
  ].filter(([part, key]) => given.section[part]?.[key] != null)
    .map(([part, key, name, unit]) => ({ part, key, name, unit, own: given.section[part][key], damping: key === "damping_ratio" }));
  const wind = { name: "highest wind speed", unit: "m/s", own: given.speed_max_m_s };
  controls.push(wind);
  // in hundredths of the value in the report, so that 100 is that value itself
  for (const c of controls) {
    const label = document.createElement("label");
    c.shown = document.createElement("output");
    c.input = Object.assign(document.createElement("input"),
      { type: "range", min: c.damping ? 0 : 50, max: c.damping ? 1000 : 200, step: c.damping ? 5 : 1 });
    // a label names the first field in it, which is the output
    label.htmlFor = c.input.id = `live-${c.part ?? "wind"}-${c.key ?? "speed"}`;
    c.input.ariaLabel = c.name;
    c.base = c.own || 0.003;
    c.start = c.own ? 100 : 0;
    c.input.value = c.start;
    c.value = () => c.base * (c.input.value / 100);
    c.input.addEventListener("input", soon);
    label.append(c.name, c.shown, c.input);
    document.getElementById("live-controls").append(label);
  }
  document.getElementById("live-reset").addEventListener("click", () => {
    for (const c of controls) c.input.value = c.start;
    update();
  });
  const request = section => ({ model: given.model, section, speeds: given.speeds,
    speed_min_m_s: given.speed_min_m_s * (wind.input.value / 100), speed_max_m_s: wind.value() });
  const changed = () => {
    const section = structuredClone(given.section);
    for (const c of controls) if (c.part) section[c.part][c.key] = c.value();
    return section;
  };
  const words = (answer, own) => {
    if (answer.error) return answer.error;
    const onset = answer.search.onset;
    const first = answer.first ? `${answer.first[0].toUpperCase()}${answer.first.slice(1)}; then: ` : "";
    if (!onset) return first + answer.words;
    const before = own.search?.onset?.speed_m_s;
    const percent = before ? 100 * (onset.speed_m_s / before - 1) : 0;
    const against = before ? ` (${percent < 0 ? "−" : "+"}${Math.abs(percent).toFixed(1)} % against this report)` : "";
    const tested = onset.in_tested_range == null ? "" : onset.in_tested_range ? ", inside the tested range" : ", OUTSIDE the tested range";
    return `${first}Flutter onset ${onset.speed_m_s.toFixed(2)} m/s${against}, ${onset.frequency_hz.toFixed(3)} Hz, ` +
      `V/(fB) ${onset.reduced_velocity.toFixed(2)}, ${onset.branch} mode${tested}`;
  };
  let own, answer, range, waiting;
  const charts = [];
  // the curves of both sections over the wind speeds of either
  const columns = key => {
    const curves = [...(answer.modes ?? []), ...(own.modes ?? [])];
    const speeds = [...new Set(curves.flatMap(m => m.speed_m_s))].sort((a, b) => a - b);
    const scale = key === "damping_ratio" ? 100 : 1;
    const of = (modes, name) => {
      const mode = modes?.find(m => m.name === name);
      const at = new Map(mode?.speed_m_s.map((v, i) => [v, scale * mode[key][i]]));
      return speeds.map(v => at.get(v) ?? null);
    };
    return [speeds, ...names.map(n => of(own.modes, n)), ...names.map(n => of(answer.modes, n))];
  };
  function update() {
    waiting = null;
    for (const c of controls) {
      const value = c.value() * (c.damping ? 100 : 1);
      const text = `${Number(value.toPrecision(4))} ${c.unit}`;
      c.shown.textContent = text;
      c.input.setAttribute("aria-valuetext", text);
    }
    if (range !== wind.input.value) own = ask(request(given.section));
    range = wind.input.value;
    answer = ask(request(changed()));
    document.getElementById("live-answer").textContent = words(answer, own);
    for (const [chart, key] of charts) chart.setData(columns(key));
  }
  function soon() { waiting ??= requestAnimationFrame(update); }
  update();
  const names = (own.modes ?? []).map(m => m.name);
  const dashes = [[], [9, 4], [2, 3]], colours = ["#0072b2", "#d55e00", "#009e73"];
  document.getElementById("live").hidden = false;
  const width = () => Math.min(960, document.getElementById("live-frequency").clientWidth - 12);
  const draw = (id, key, label, digits, fixed) => {
    const value = (u, v) => v == null ? "–" : v.toFixed(digits);
    const line = (name, i, grey) => ({ label: grey ? `${name}, report` : name, value, spanGaps: false,
      stroke: grey ? "#999" : colours[i % 3], width: grey ? 1 : 2, dash: dashes[i % 3] });
    const chart = new uPlot({
      width: width(), height: 260, scales: { x: { time: false }, y: fixed ? { range: fixed } : {} },
      axes: [{ label: "Wind speed V (m/s)" }, { label }], cursor: { sync: { key: "live" } },
      series: [{ label: "V (m/s)", value: (u, v) => v == null ? "–" : v.toFixed(2) },
        ...names.map((n, i) => line(n, i, true)), ...names.map((n, i) => line(n, i, false))],
      hooks: { draw: [u => {
        const c = u.ctx, { left, top, width, height } = u.bbox;
        c.save(); c.strokeStyle = "#666"; c.setLineDash([4, 4]); c.beginPath();
        if (fixed) { const y = u.valToPos(0, "y", true); c.moveTo(left, y); c.lineTo(left + width, y); }
        const speed = answer.search?.onset?.speed_m_s;
        if (speed) { const x = u.valToPos(speed, "x", true); c.moveTo(x, top); c.lineTo(x, top + height); }
        c.stroke(); c.restore();
      }] },
    }, columns(key), document.getElementById(id));
    window.addEventListener("resize", () => chart.setSize({ width: width(), height: 260 }));
    charts.push([chart, key]);
  };
  draw("live-frequency", "frequency_hz", "Frequency (Hz)", 4);
  draw("live-damping", "damping_ratio", "Damping ratio (%)", 3, [-5, 10]);
})();
