// Shows the object of the page: texts and tables, charts, and the mechanism in space.
"use strict";
(() => {
  const report = JSON.parse(document.getElementById("data").textContent);
  const byId = (id) => document.getElementById(id);
  const element = (name, text, parent, className) => {
    const own = document.createElement(name);
    if (text !== undefined && text !== null) own.textContent = text;
    if (className) own.className = className;
    if (parent) parent.append(own);
    return own;
  };
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
  const floats = (text) => new Float32Array(bytes(text));
  /** Up to five digits, as people write them. */
  const brief = (x) => {
    if (x === null || x === undefined || Number.isNaN(x)) return "";
    const size = Math.abs(x);
    return size !== 0 && (size < 1e-3 || size >= 1e5) ? Number(x.toPrecision(4)).toExponential() : String(Number(x.toPrecision(5)));
  };

  // texts and tables
  document.title = `${report.title}: ${report.what}`;
  byId("title").textContent = report.title;
  byId("summary").textContent = [report.summary, report.what].filter(Boolean).join(" · ");
  byId("version").textContent = report.version;
  byId("command").textContent = report.command ?? "";
  byId("command").parentElement.hidden = !report.command;
  byId("files").hidden = !(report.files ?? []).length;
  (report.files ?? []).forEach((name, k) => {
    byId("files").append(k ? " · " : "");
    element("a", name, byId("files")).href = name.split("/").map(encodeURIComponent).join("/");
  });
  for (const [name, value] of report.facts ?? []) {
    const pair = element("div", null, byId("facts"));
    element("dt", name, pair);
    element("dd", value, pair);
  }
  for (const text of report.warnings ?? []) element("p", text, byId("warnings"), "warning");
  for (const text of report.notes ?? []) element("li", text, byId("notes"));
  const isNumber = (cell) => typeof cell === "number" || (typeof cell === "string" && /^-?(\d|inf|NaN)/.test(cell) && Number.isFinite(Number(cell)));
  (report.tables ?? []).forEach(({ heading, columns, rows }, index) => {
    const card = index === 0 ? byId("first") : element("section", null, byId("tables"));
    element("h2", heading, card);
    const table = element("table", null, element("div", null, card, "scroll"));
    const numeric = columns.map((_, k) => rows.some((row) => isNumber(row[k])));
    const head = element("tr", null, element("thead", null, table));
    columns.forEach((name, k) => element("th", name, head, numeric[k] ? "number" : ""));
    const body = element("tbody", null, table);
    for (const row of rows) {
      const line = element("tr", null, body);
      row.forEach((cell, k) => element("td", typeof cell === "number" ? brief(cell) : cell, line, numeric[k] ? "number" : ""));
    }
  });

  // bars to both sides of zero, the longest above
  const mostBars = 24;
  for (const { heading, label, bars } of report.bars ?? []) {
    const card = element("section", null, byId("bars"));
    const known = bars.filter(([, value]) => value !== null).sort((a, b) => Math.abs(b[1]) - Math.abs(a[1]));
    const more = known.length - mostBars;
    element("h2", heading, card);
    element("p", label + (more > 0 ? `; ${more} smaller ones are not shown` : ""), card);
    const grid = element("div", null, card, "bars");
    for (const [name, value] of known.slice(0, mostBars)) {
      element("span", name, grid);
      const bar = element("i", null, element("div", null, grid), value < 0 ? "below" : "");
      bar.style.width = `${(50 * Math.abs(value)) / (Math.abs(known[0][1]) || 1)}%`;
      element("span", brief(value), grid);
    }
  }

  // charts
  const palette = ["#0b6bcb", "#d1600a", "#2c8a3d", "#9a3fb5", "#c2334d", "#0f8b8d", "#7a6a00"];
  const style = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const charts = [];
  let now = null;
  const events = report.events ?? [];
  // curves of the same things in several charts are named in the first of them
  const named = (chart) => chart.series.length < 2 || chart.series.some((own) => own.name) ? chart
    : report.charts.find((other) => other.series.length === chart.series.length && other.series.every((own) => own.name)) ?? chart;
  for (const chart of report.charts ?? []) {
    const card = element("div", null, byId("charts"), "card");
    element("h3", chart.title || chart.y_label, card);
    const box = element("div", null, card);
    const x = floats(chart.x);
    const data = [x, ...chart.series.map((own) => Array.from(floats(own.y), (y) => (Number.isFinite(y) && (!chart.log || y > 0) ? y : null)))];
    const few = x.length < 80 && !chart.series.some((own) => own.dots);
    const axis = (label, size) => ({ label, stroke: () => style("--soft"), grid: { stroke: () => style("--line"), width: 1 }, ticks: { show: false },
      size, labelSize: 18, font: "12px system-ui", labelFont: "12px system-ui", values: (_, all) => all.map((value) => (value === null ? "" : brief(value))) });
    const overTime = chart.x_label.startsWith("time");
    const options = {
      width: 400, height: 230, scales: { x: { time: false }, y: { distr: chart.log ? 3 : 1 } },
      axes: [axis(chart.x_label, 34), axis(chart.y_label, 62)],
      cursor: { sync: { key: overTime ? "time" : chart.x_label }, drag: { x: true, y: true, uni: 20 } },
      series: [{ label: chart.x_label, value: (_, value) => brief(value) }, ...chart.series.map((own, k) => ({
        label: own.name || named(chart).series[k].name || chart.y_label, stroke: palette[k % palette.length], width: 1.6, ...(own.dots && { paths: () => null }),
        points: { show: own.dots || few, ...(own.dots && { size: 5, fill: palette[k % palette.length] }) }, value: (_, value) => brief(value) }))],
      hooks: { draw: [(plot) => {
        if (!overTime) return;
        const line = (t, dashes) => {
          const at = plot.valToPos(t, "x", true);
          if (at < plot.bbox.left || at > plot.bbox.left + plot.bbox.width) return;
          plot.ctx.setLineDash(dashes);
          plot.ctx.beginPath();
          plot.ctx.moveTo(at, plot.bbox.top);
          plot.ctx.lineTo(at, plot.bbox.top + plot.bbox.height);
          plot.ctx.stroke();
        };
        plot.ctx.save();
        plot.ctx.strokeStyle = style("--soft");
        events.forEach((event) => line(event.t, [1, 3]));
        if (now !== null) line(now, [4, 4]);
        plot.ctx.restore();
      }] },
    };
    const plot = new Viewer.uPlot(options, data, box);
    charts.push({ plot, overTime });
    // in the next frame: the new size must not be a new notice of the observer
    new ResizeObserver(() => requestAnimationFrame(() => {
      const width = Math.max(260, card.clientWidth - 36);
      if (width !== plot.width) plot.setSize({ width, height: 230 });
    })).observe(card);
  }
  const mark = (t) => {
    now = t;
    charts.forEach(({ plot, overTime }) => overTime && plot.redraw(false, false));
  };

  // the mechanism in space
  const state = { ready: true, frame: 0, time: null, colour: "plain", webgl: false };
  window.costate = { state, report };
  if (!report.space || !(report.clips ?? []).length) return;
  byId("space").hidden = false;
  const { count, view } = report.space;
  const triangles = new Uint32Array(bytes(report.space.triangles));
  const partOf = new Uint32Array(bytes(report.space.solids));
  const edges = new Uint32Array(bytes(report.space.edges));
  const clips = report.clips.map((own) => {
    const times = floats(own.times);
    const axes = own.axes.map(({ least, step, numbers }) => ({ least, step, numbers: new Uint16Array(bytes(numbers)) }));
    const stress = own.stress && { ...own.stress, numbers: new Uint16Array(bytes(own.stress.numbers)) };
    return { ...own, times, axes, stress };
  });
  let clip = clips[0];
  const place = (frame, vertex, axis) => clip.axes[axis].least + clip.axes[axis].step * clip.axes[axis].numbers[frame * count + vertex];
  const positions = new Float32Array(3 * count);
  /** Places at a time: straight lines between the kept frames. */
  const move = (time) => {
    const { times } = clip;
    let frame = 0;
    while (frame + 2 < times.length && times[frame + 1] <= time) frame += 1;
    const next = Math.min(frame + 1, times.length - 1);
    const span = times[next] - times[frame];
    const share = span > 0 ? Math.min(1, Math.max(0, (time - times[frame]) / span)) : 0;
    for (let axis = 0; axis < 3; axis += 1) {
      for (let vertex = 0; vertex < count; vertex += 1) {
        const from = place(frame, vertex, axis);
        positions[3 * vertex + axis] = from + share * (place(next, vertex, axis) - from);
      }
    }
    state.frame = share < 0.5 ? frame : next;
    return [frame, next, share];
  };

  const T = Viewer;
  const canvas = byId("canvas");
  let renderer;
  try {
    renderer = new T.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
    state.webgl = true;
  } catch {
    byId("no-webgl").hidden = false;
  }
  const scene = new T.Scene();
  scene.add(new T.HemisphereLight(0xffffff, 0x8a94a3, 1.9));
  const camera = new T.PerspectiveCamera(32, 1, 0.01, 100);
  const lamp = new T.DirectionalLight(0xffffff, 1.7);
  camera.add(lamp);
  scene.add(camera);

  // the box around everything at all times
  let low, high, middle, size;
  const measure = () => {
    low = clip.axes.map(({ least }) => least);
    high = clip.axes.map(({ least, step, numbers }) => least + step * numbers.reduce((a, b) => Math.max(a, b), 0));
    for (const anchor of report.space.anchors) anchor.forEach((x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); });
    middle = low.map((x, k) => 0.5 * (x + high[k]));
    size = Math.max(1e-9, Math.hypot(...low.map((x, k) => high[k] - x)));
  };
  measure();
  const up = view === "Xy" ? [0, 1, 0] : [0, 0, 1];
  const from = { Xy: [0.16, 0.12, 1], Xz: [0.16, -1, 0.12], Yz: [1, 0.16, 0.12], Isometric: [0.85, -1, 0.6] }[view];
  camera.up.set(...up);
  const controls = new T.OrbitControls(camera, canvas);
  controls.enableDamping = false;
  const fit = () => {
    // so far away that all corners of the box are seen
    const direction = new T.Vector3(...from).normalize();
    const right = new T.Vector3(...up).cross(direction).normalize();
    const above = direction.clone().cross(right);
    const slope = Math.tan((camera.fov * Math.PI) / 360);
    let distance = 0;
    for (let corner = 0; corner < 8; corner += 1) {
      const point = new T.Vector3(...low.map((x, k) => (corner >> k & 1 ? high[k] : x) - middle[k]));
      const across = Math.abs(point.dot(right)) / (slope * camera.aspect), over = Math.abs(point.dot(above)) / slope;
      distance = Math.max(distance, point.dot(direction) + Math.max(across, over));
    }
    distance = Math.max(distance * 1.12, 1.2 * size * 0.5);
    controls.target.set(...middle);
    camera.position.set(...middle).addScaledVector(direction, distance);
    camera.near = distance / 200;
    camera.far = distance * 60;
    camera.updateProjectionMatrix();
    controls.update();
  };

  // solid surfaces with their outlines
  const geometry = new T.BufferGeometry();
  const placeAttribute = new T.BufferAttribute(positions, 3).setUsage(T.DynamicDrawUsage);
  const colours = new Float32Array(3 * count);
  const colourAttribute = new T.BufferAttribute(colours, 3).setUsage(T.DynamicDrawUsage);
  geometry.setAttribute("position", placeAttribute);
  geometry.setAttribute("color", colourAttribute);
  geometry.setIndex(new T.BufferAttribute(triangles, 1));
  const solid = new T.Mesh(geometry, new T.MeshStandardMaterial({ vertexColors: true, side: T.DoubleSide, roughness: 0.75, metalness: 0.05, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }));
  solid.frustumCulled = false;
  const outlines = new T.BufferGeometry();
  outlines.setAttribute("position", placeAttribute);
  outlines.setIndex(new T.BufferAttribute(edges, 1));
  const outline = new T.LineSegments(outlines, new T.LineBasicMaterial({ color: 0x1b2430, transparent: true, opacity: 0.35 }));
  outline.frustumCulled = false;
  if (triangles.length) scene.add(solid, outline);

  // bodies and links as rods, joints and masses as balls
  const segments = [], balls = [];
  const isSingle = triangles.length === 0;
  for (const { link, part, vertices } of report.space.rods) {
    const radius = size * (link ? 0.0032 : isSingle ? 0.0085 : 0.006);
    for (let k = 0; k + 1 < vertices.length; k += 1) segments.push({ a: vertices[k], b: vertices[k + 1], radius, link, part });
    vertices.forEach((vertex) => balls.push({ vertex, radius: radius * (link ? 1.5 : 1.35), link, part }));
  }
  report.space.points.forEach(([vertex, part]) => balls.push({ vertex, radius: size * 0.014, link: false, part }));
  const material = () => new T.MeshStandardMaterial({ roughness: 0.6, metalness: 0.1 });
  const cylinders = new T.InstancedMesh(new T.CylinderGeometry(1, 1, 1, 14, 1), material(), Math.max(1, segments.length));
  const spheres = new T.InstancedMesh(new T.SphereGeometry(1, 18, 12), material(), Math.max(1, balls.length));
  cylinders.frustumCulled = spheres.frustumCulled = false;
  cylinders.count = segments.length;
  spheres.count = balls.length;
  scene.add(cylinders, spheres);

  // what holds it to the ground, a grid, and the paths of points
  const cone = new T.ConeGeometry(1, 1.6, 4);
  cone.translate(0, -0.8, 0);
  const anchorMaterial = new T.MeshStandardMaterial({ color: 0x7d8896, roughness: 0.9 });
  for (const anchor of report.space.anchors) {
    const own = new T.Mesh(cone, anchorMaterial);
    own.scale.setScalar(size * 0.022);
    if (up[2]) own.rotation.x = Math.PI / 2;
    own.position.set(...anchor);
    scene.add(own);
  }
  const round = (x) => {
    const power = 10 ** Math.floor(Math.log10(x));
    return power * [1, 2, 5, 10].find((step) => step * power >= x * 0.999);
  };
  const cell = round(size / 8);
  const cells = 2 * Math.ceil((0.75 * size) / cell);
  let grid;
  const drawGrid = () => {
    if (grid) scene.remove(grid);
    const dark = matchMedia("(prefers-color-scheme: dark)").matches;
    const line = dark ? 0x2d3641 : 0xd3dae2;
    grid = new T.GridHelper(cells * cell, cells, line, line);
    if (up[2]) grid.rotation.x = Math.PI / 2;
    const snapped = middle.map((x) => Math.round(x / cell) * cell);
    const axis = up[2] ? 2 : 1;
    snapped[axis] = low[axis] - 0.03 * size;
    grid.position.set(...snapped);
    scene.add(grid);
    draw();
  };
  const trailMaterials = [];
  const legend = byId("legend");
  let trails = [];
  const { parts } = report.space;
  /** A colour for each body; behind those of the palette they go around the circle by the golden angle. */
  const colourOf = (part) => (part < palette.length ? palette[part] : `hsl(${(137.5 * part) % 360}, 60%, 42%)`);
  const trailColour = (k) => palette[((parts.length < palette.length ? Math.max(1, parts.length) : 1) + k) % palette.length];
  const drawTrails = () => {
    trails.forEach((own) => scene.remove(own));
    trails = [];
    legend.textContent = "";
    if (parts.length > 1 && state.colour === "plain") {
      parts.slice(0, 12).forEach((name, part) => {
        element("i", "", legend, "part").style.color = colourOf(part);
        legend.append(name);
      });
    }
    report.space.followed.slice(0, 7).forEach(({ name, vertex }, k) => {
      const points = new Float32Array(clip.times.length * 3);
      clip.times.forEach((_, frame) => [0, 1, 2].forEach((axis) => { points[3 * frame + axis] = place(frame, vertex, axis); }));
      const own = new T.Line(new T.BufferGeometry().setAttribute("position", new T.BufferAttribute(points, 3)),
        trailMaterials[k] ??= new T.LineBasicMaterial({ color: trailColour(k), transparent: true, opacity: 0.75 }));
      own.frustumCulled = false;
      trails.push(own);
      scene.add(own);
      const line = element("i", "", legend);
      line.style.color = trailColour(k);
      legend.append(`path of ${name}`);
    });
    element("span", `${legend.textContent ? " · " : ""}grid: ${brief(cell)} m`, legend);
  };

  // colours: viridis for sizes, blue over grey to red for what has a sign
  const viridis = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];
  const signed = [[33, 80, 180], [107, 150, 220], [190, 208, 232], [226, 226, 226], [240, 196, 176], [222, 120, 96], [178, 24, 43]];
  const between = (table, share) => {
    const at = Math.min(1, Math.max(0, share)) * (table.length - 1);
    const first = Math.min(table.length - 2, Math.floor(at));
    return table[first].map((x, k) => (x + (at - first) * (table[first + 1][k] - x)) / 255);
  };
  const linear = (x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
  const shade = (table) => Array.from({ length: 256 }, (_, k) => between(table, k / 255).map(linear));
  const shades = { viridis: shade(viridis), signed: shade(signed) };
  const ofParts = parts.map((_, part) => new T.Color(colourOf(part)).toArray());
  const plain = { solid: [0.36, 0.55, 0.76].map(linear), rod: [0.09, 0.42, 0.72].map(linear), link: [0.85, 0.48, 0.1].map(linear) };
  const modes = [{ key: "plain", name: "part" }, { key: "displacement", name: "displacement [m]", shades: shades.viridis, table: viridis }];
  if (clips.some((own) => own.stress)) modes.push({ key: "stress", name: "stress [N/m2]", shades: shades.viridis, table: viridis });
  (report.colourings ?? []).forEach(({ name, unit, values }, k) => {
    modes.push({ key: `gradient ${k}`, name: `${name} [${unit}]`, shades: shades.signed, table: signed, values: floats(values) });
  });
  let colouring = modes[0];
  const values = new Float32Array(count);
  const rest = new Float32Array(3 * count);
  const restOf = () => {
    const frames = clip.swings ? clip.times.length - 1 : 1;
    for (let vertex = 0; vertex < count; vertex += 1) {
      for (let axis = 0; axis < 3; axis += 1) {
        let sum = 0;
        for (let frame = 0; frame < frames; frame += 1) sum += place(frame, vertex, axis);
        rest[3 * vertex + axis] = sum / frames;
      }
    }
  };
  const largestDisplacement = () => {
    let most = 0;
    for (let frame = 0; frame < clip.times.length; frame += 1) {
      for (let vertex = 0; vertex < count; vertex += 1) {
        most = Math.max(most, Math.hypot(...[0, 1, 2].map((axis) => place(frame, vertex, axis) - rest[3 * vertex + axis])));
      }
    }
    return most;
  };
  let range = [0, 1];
  const setRange = () => {
    if (colouring.key === "displacement") range = [0, largestDisplacement()];
    else if (colouring.key === "stress" && clip.stress) range = [0, clip.stress.least + clip.stress.step * 65534];
    else if (colouring.values) {
      const most = colouring.values.reduce((a, b) => (Number.isFinite(b) ? Math.max(a, Math.abs(b)) : a), 0);
      range = [-most, most];
    }
    const key = byId("key");
    key.hidden = colouring.key === "plain";
    if (key.hidden) return;
    byId("key-name").textContent = colouring.name;
    byId("key-least").textContent = brief(range[0]);
    byId("key-most").textContent = brief(range[1]);
    const strip = byId("key-strip").getContext("2d");
    for (let k = 0; k < 256; k += 1) {
      strip.fillStyle = `rgb(${between(colouring.table, k / 255).map((x) => Math.round(255 * x)).join(",")})`;
      strip.fillRect(k, 0, 1, 1);
    }
  };
  const valueOf = (vertex, [frame, next, share]) => {
    if (colouring.key === "displacement") return Math.hypot(positions[3 * vertex] - rest[3 * vertex], positions[3 * vertex + 1] - rest[3 * vertex + 1], positions[3 * vertex + 2] - rest[3 * vertex + 2]);
    if (colouring.key === "stress") {
      if (!clip.stress) return NaN;
      const { least, step, numbers } = clip.stress;
      const [a, b] = [numbers[frame * count + vertex], numbers[next * count + vertex]];
      return a === 65535 || b === 65535 ? NaN : least + step * (a + share * (b - a));
    }
    return colouring.values ? colouring.values[vertex] : NaN;
  };
  const ofRod = (link, part) => (link ? plain.link : parts.length > 1 ? ofParts[part] : plain.rod);
  const grey = [0.62, 0.65, 0.69].map(linear);
  const shadeOf = (value, otherwise) => {
    if (!Number.isFinite(value)) return colouring.key === "plain" ? otherwise : grey;
    const share = range[1] > range[0] ? (value - range[0]) / (range[1] - range[0]) : 0.5;
    return colouring.shades[Math.min(255, Math.max(0, Math.round(255 * share)))];
  };

  const draw = () => {
    if (!renderer) return;
    renderer.render(scene, camera);
  };
  const matrix = new T.Matrix4(), turn = new T.Quaternion(), along = new T.Vector3(), upright = new T.Vector3(0, 1, 0);
  const start = new T.Vector3(), end = new T.Vector3(), scale = new T.Vector3(), colour = new T.Color();
  const show = (time) => {
    state.time = time;
    const at = move(time);
    byId("time").value = time;
    const latest = clip.swings ? undefined : events.findLast((event) => event.t <= time);
    const clock = clip.swings ? `${brief((360 * time) / clip.times[clip.times.length - 1])}°`
      : `t = ${time.toFixed(time < 10 ? 3 : 2)} s${latest ? `, after ${latest.name} at ${brief(latest.t)} s` : ""}`;
    byId("clock").textContent = clock;
    byId("time").setAttribute("aria-valuetext", clock);
    canvas.dataset.frame = state.frame;
    if (!clip.swings) mark(time);
    if (!renderer) return;
    for (let vertex = 0; vertex < count; vertex += 1) {
      values[vertex] = valueOf(vertex, at);
      const own = shadeOf(values[vertex], partOf[vertex] < parts.length ? ofRod(false, partOf[vertex]) : plain.solid);
      colours[3 * vertex] = own[0];
      colours[3 * vertex + 1] = own[1];
      colours[3 * vertex + 2] = own[2];
    }
    placeAttribute.needsUpdate = colourAttribute.needsUpdate = true;
    if (triangles.length) geometry.computeVertexNormals();
    segments.forEach(({ a, b, radius, link, part }, k) => {
      start.fromArray(positions, 3 * a);
      end.fromArray(positions, 3 * b);
      along.subVectors(end, start);
      const length = along.length();
      turn.setFromUnitVectors(upright, length > 0 ? along.divideScalar(length) : upright);
      matrix.compose(start.add(end).multiplyScalar(0.5), turn, scale.set(radius, Math.max(length, 1e-12), radius));
      cylinders.setMatrixAt(k, matrix);
      cylinders.setColorAt(k, colour.setRGB(...shadeOf(0.5 * (values[a] + values[b]), ofRod(link, part))));
    });
    balls.forEach(({ vertex, radius, link, part }, k) => {
      matrix.makeScale(radius, radius, radius).setPosition(positions[3 * vertex], positions[3 * vertex + 1], positions[3 * vertex + 2]);
      spheres.setMatrixAt(k, matrix);
      spheres.setColorAt(k, colour.setRGB(...shadeOf(values[vertex], ofRod(link, part))));
    });
    for (const own of [cylinders, spheres]) {
      own.instanceMatrix.needsUpdate = true;
      if (own.instanceColor) own.instanceColor.needsUpdate = true;
    }
    draw();
  };

  // until a reader takes hold of it, everything stays in sight
  let turned = false;
  controls.addEventListener("start", () => { turned = true; });
  const resize = () => {
    const stage = byId("stage");
    if (!renderer || !stage.clientWidth) return;
    renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    renderer.setSize(stage.clientWidth, stage.clientHeight, false);
    camera.aspect = stage.clientWidth / stage.clientHeight;
    camera.updateProjectionMatrix();
    if (!turned) fit();
    draw();
  };

  // what a reader does
  const slider = byId("time"), play = byId("play"), speed = byId("speed"), clipList = byId("clip"), colourList = byId("colour");
  const factors = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10];
  factors.forEach((factor) => { element("option", `${factor} ×`, speed).value = factor; });
  let playing = false, before = null;
  const last = () => clip.times[clip.times.length - 1];
  const pace = () => (clip.swings ? (last() - clip.times[0]) * 0.5 * Number(speed.value) : Number(speed.value));
  const tick = (stamp) => {
    if (!playing) return;
    if (before !== null) {
      let time = state.time + ((stamp - before) / 1000) * pace();
      if (time > last()) time = clip.swings ? clip.times[0] + ((time - clip.times[0]) % (last() - clip.times[0])) : clip.times[0];
      show(time);
    }
    before = stamp;
    requestAnimationFrame(tick);
  };
  const setPlaying = (on) => {
    playing = on && last() > clip.times[0];
    before = null;
    play.textContent = playing ? "❚❚" : "▶";
    play.setAttribute("aria-label", playing ? "Pause" : "Play");
    if (playing) requestAnimationFrame(tick);
  };
  play.addEventListener("click", () => setPlaying(!playing));
  slider.addEventListener("input", () => { setPlaying(false); show(Number(slider.value)); });
  // the arrow keys of a slider without steps would jump: a hundredth of the motion each
  slider.addEventListener("keydown", (event) => {
    const step = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1, PageUp: 10, PageDown: -10 }[event.key];
    if (step === undefined) return;
    event.preventDefault();
    setPlaying(false);
    const span = last() - clip.times[0];
    show(Math.min(last(), Math.max(clip.times[0], state.time + (step * span) / 100)));
  });
  const refit = () => { turned = false; fit(); draw(); };
  byId("fit").addEventListener("click", refit);
  document.addEventListener("keydown", (event) => {
    if (["SELECT", "BUTTON", "SUMMARY"].includes(event.target.tagName)) return;
    if (event.key === " ") { event.preventDefault(); setPlaying(!playing); }
    if (event.key === "f" && !event.ctrlKey && !event.metaKey) refit();
  });
  clips.forEach(({ name }, k) => { element("option", name, clipList).value = k; });
  byId("clip-label").hidden = clips.length < 2;
  modes.forEach(({ name, key }) => { element("option", name, colourList).value = key; });
  const choose = () => {
    clip = clips[Number(clipList.value || 0)];
    slider.min = clip.times[0];
    slider.max = last();
    const natural = clip.swings ? 1 : factors.reduce((a, b) => (Math.abs(Math.log((last() - clip.times[0]) / b / 7)) < Math.abs(Math.log((last() - clip.times[0]) / a / 7)) ? b : a));
    speed.value = natural;
    restOf();
    setRange();
    drawTrails();
    show(clip.times[0]);
  };
  clipList.addEventListener("change", choose);
  colourList.addEventListener("change", () => {
    colouring = modes.find(({ key }) => key === colourList.value);
    state.colour = colouring.key;
    setRange();
    drawTrails();
    show(state.time);
  });
  controls.addEventListener("change", draw);
  new ResizeObserver(() => requestAnimationFrame(resize)).observe(byId("stage"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { drawGrid(); charts.forEach(({ plot }) => plot.redraw()); });
  fit();
  resize();
  drawGrid();
  choose();
})();
