// The page of a run: draws the document in the element #run.
"use strict";

(() => {
  const run = JSON.parse(document.getElementById("run").textContent);
  const { verdicts, truthColour, element, styleOf: style, ellipseOf, unwrapped, View, LinePath } = sonopose;
  const runColours = ["#1f77d0", "#d0571f"];
  const isCompared = run.runs.length > 1;

  // Head

  document.title = run.title;
  const header = element("header", {}, [element("h1", { textContent: run.title })]);
  for (const each of run.runs) header.append(element("p", { textContent: `${each.name}: ${each.settings}` }));
  const map = element("section", { className: "map" });
  const plots = element("section", { className: "plots" });
  document.body.append(header, element("main", {}, [map, plots]));

  // Time plots: all show the same part of the time.

  const graphs = [];
  let isSynchronising = false;
  let marked = null; // time of the pointer, s
  const synchronise = (from, isInitial) => {
    if (isSynchronising || isInitial) return;
    isSynchronising = true;
    const dateWindow = from.xAxisRange();
    for (const graph of graphs) if (graph !== from) graph.updateOptions({ dateWindow });
    isSynchronising = false;
    drawMap();
  };

  const series = (run_index, name, colour, column, scale = 1, options = {}) => ({
    name: isCompared && run_index >= 0 ? `${name} (${run.runs[run_index].name})` : name,
    colour,
    times: column.t,
    values: column.values,
    deviations: options.deviations,
    scale,
    options,
  });

  // Rows of all times of the series, with null where one has no value.
  const rowsOf = (all, hasBars) => {
    const rows = new Map();
    all.forEach((each, k) => {
      each.times.forEach((t, i) => {
        const value = each.values[i];
        if (value === null || t === null) return;
        if (!rows.has(t)) rows.set(t, [t, ...new Array(all.length).fill(hasBars ? [null, null, null] : null)]);
        const mid = value * each.scale;
        const spread = 3 * each.scale * ((each.deviations && each.deviations[i]) || 0);
        rows.get(t)[k + 1] = hasBars ? [mid - spread, mid, mid + spread] : mid;
      });
    });
    return [...rows.values()].sort((a, b) => a[0] - b[0]);
  };

  const addPlot = (title, unit, all, range = null) => {
    const filled = all.filter((each) => each.values.some((value) => value !== null));
    if (filled.length === 0) return;
    const legend = element("span");
    const graph = element("div", { className: "graph" });
    plots.append(
      element("div", { className: "plot" }, [element("h2", { textContent: `${title}, ${unit} ` }, []), graph]),
    );
    graph.previousSibling.append(legend);
    const hasBars = filled.some((each) => each.deviations);
    const options = {};
    for (const each of filled) {
      options[each.name] = each.options.isPoints
        ? { strokeWidth: 0, drawPoints: true, pointSize: each.options.pointSize || 2 }
        : { strokeWidth: 1.3, strokePattern: each.options.isDashed ? [5, 4] : null };
    }
    graphs.push(
      new Dygraph(graph, rowsOf(filled, hasBars), {
        labels: ["t", ...filled.map((each) => each.name)],
        colors: filled.map((each) => each.colour),
        series: options,
        customBars: hasBars,
        fillAlpha: 0.15,
        connectSeparatedPoints: true,
        labelsDiv: legend,
        labelsSeparateLines: false,
        axisLineColor: style("--grid"),
        gridLineColor: style("--grid"),
        xRangePad: 4,
        valueRange: range,
        digitsAfterDecimal: 2,
        axes: { x: { valueFormatter: (t) => `${t.toFixed(2)} s` } },
        drawCallback: synchronise,
        highlightCallback: (event, t) => {
          marked = t;
          drawMap();
        },
        unhighlightCallback: () => {
          marked = null;
          drawMap();
        },
      }),
    );
  };

  const of = (k, name) => ({ t: run.runs[k].moments.t, values: run.runs[k].moments[name] });
  const indices = run.runs.map((each, k) => k);
  const fused = (name, scale, deviations) =>
    indices.map((k) =>
      series(k, "fused", runColours[k], of(k, name), scale, {
        deviations: deviations && run.runs[k].moments[deviations],
      }),
    );
  const withTruth = (all, name, scale) =>
    run.has_truth ? [...all, series(-1, "truth", truthColour, of(0, name), scale, { isDashed: true })] : all;

  // Without steps at 180 degrees; the truth and a second run lie beside the first run.
  const yaws = () => {
    const yaw = unwrapped(run.runs[0].moments.yaw_deg);
    const all = indices.map((k) => {
      const { t, yaw_deg, yaw_std_deg: deviations } = run.runs[k].moments;
      const isAligned = k > 0 && t.length === yaw.length;
      const values = k === 0 ? yaw : unwrapped(yaw_deg, isAligned ? yaw : null);
      return series(k, "fused", runColours[k], { t, values }, 1, { deviations });
    });
    if (!run.has_truth) return all;
    const { t, true_yaw_deg } = run.runs[0].moments;
    return [...all, series(-1, "truth", truthColour, { t, values: unwrapped(true_yaw_deg, yaw) }, 1, { isDashed: true })];
  };

  if (run.has_truth) {
    // The scale is that of the fused errors; those of the last fix may exceed it.
    const errors = indices.flatMap((k) => run.runs[k].moments.error_m).filter((error) => error !== null);
    const usual_m = errors.sort((a, b) => a - b)[Math.floor(0.995 * errors.length)] || 0.01;
    const all = [
      ...fused("error_m", 100),
      series(-1, "last fix", "#9aa5b1", of(0, "last_fix_error_m"), 100, { isDashed: true }),
    ];
    addPlot("Position error", "cm", all, [0, 200 * usual_m]);
  }
  const innovations = [];
  verdicts.forEach((verdict, group) => {
    indices.forEach((k) => {
      const fixes = run.runs[k].fixes;
      const chosen = fixes.t.map((t, i) => i).filter((i) => fixes.verdict[i] === group);
      const column = { t: chosen.map((i) => fixes.t[i]), values: chosen.map((i) => fixes.innovation_m[i]) };
      innovations.push(
        series(k, verdict.name, verdict.colour, column, 100, { isPoints: true, pointSize: group === 0 ? 1.5 : 2.5 }),
      );
    });
  });
  addPlot("Innovations", "cm", innovations);
  addPlot("Height", "m", withTruth(fused("z_m", 1, "z_std_m"), "true_z_m", 1));
  addPlot("Yaw", "°", yaws());
  addPlot("Speed", "m/s", withTruth(fused("speed_mps", 1), "true_speed_mps", 1));
  addPlot("Trust", "0 to 1", fused("trust", 1));
  addPlot("Delay of the fixes", "ms", [
    series(-1, "delay", "#7a5fb0", { t: run.arrivals.t, values: run.arrivals.delay_s }, 1000, { isPoints: true }),
  ]);

  // Map

  const canvas = element("canvas", { title: "Wheel: zoom. Drag: move. Double click: all." });
  const legend = element("div", { className: "legend" });
  map.append(canvas, legend);
  const layers = [];
  const addLayer = (name, colour, isDot, isShown, draw) => {
    const box = element("input", { type: "checkbox", checked: isShown });
    box.addEventListener("change", () => drawMap());
    const swatch = element("i", { className: isDot ? "dot" : "" });
    swatch.style.background = colour;
    legend.append(element("label", {}, [box, swatch, document.createTextNode(name)]));
    layers.push({ box, draw });
  };

  const view = new View([1e-2, 1e5]);
  const context = canvas.getContext("2d");
  const toPixel = (x, y) => view.toScreen(x, y);

  const line = (xs, ys, colour, width, dash) => {
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.setLineDash(dash || []);
    const path = new LinePath(context, view);
    xs.forEach((x, i) => path.add(i, x, ys[i]));
    path.stroke();
    context.setLineDash([]);
  };

  const isInWindow = (t) => {
    if (graphs.length === 0) return true;
    const [from, to] = graphs[0].xAxisRange();
    return t >= from && t <= to;
  };

  verdicts.forEach((verdict, group) => {
    addLayer(`fixes: ${verdict.name}`, verdict.colour, true, true, () => {
      const fixes = run.runs[0].fixes;
      context.fillStyle = verdict.colour;
      fixes.t.forEach((t, i) => {
        if (fixes.verdict[i] !== group || !isInWindow(t)) return;
        const [px, py] = toPixel(fixes.x_m[i], fixes.y_m[i]);
        context.fillRect(px - 1.5, py - 1.5, 3, 3);
      });
    });
  });
  if (run.has_truth) {
    addLayer("truth", truthColour, false, true, () => {
      line(run.runs[0].path.true_x_m, run.runs[0].path.true_y_m, truthColour, 1.2, [6, 4]);
    });
  }
  run.runs.forEach((each, k) => {
    addLayer(isCompared ? each.name : "fused path", runColours[k], false, true, () => {
      line(each.path.x_m, each.path.y_m, runColours[k], 1.6);
    });
  });

  const drawScaleBar = () => {
    const exponent = Math.floor(Math.log10(120 / view.scale));
    const bar_m = [1, 2, 5, 10].map((f) => f * 10 ** exponent).filter((m) => m * view.scale <= 130).pop();
    const y = canvas.clientHeight - 14;
    context.strokeStyle = context.fillStyle = style("--text");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(14, y);
    context.lineTo(14 + bar_m * view.scale, y);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.fillText(`${bar_m >= 1 ? bar_m : bar_m.toPrecision(1)} m`, 14, y - 6);
  };

  const drawGrid = () => {
    const step = 10 ** Math.ceil(Math.log10(60 / view.scale));
    const [left, top] = view.toWorld(0, 0);
    context.strokeStyle = style("--grid");
    context.lineWidth = 1;
    context.beginPath();
    for (let x = Math.ceil(left / step) * step; toPixel(x, 0)[0] < canvas.clientWidth; x += step) {
      context.moveTo(toPixel(x, 0)[0], 0);
      context.lineTo(toPixel(x, 0)[0], canvas.clientHeight);
    }
    for (let y = Math.floor(top / step) * step; toPixel(0, y)[1] < canvas.clientHeight; y -= step) {
      context.moveTo(0, toPixel(0, y)[1]);
      context.lineTo(canvas.clientWidth, toPixel(0, y)[1]);
    }
    context.stroke();
  };

  // The pose at the time of the pointer: position, 3 sigma, heading.
  const drawMarked = () => {
    if (marked === null) return;
    run.runs.forEach((each, k) => {
      const moments = each.moments;
      const i = moments.t.findIndex((t) => t >= marked);
      if (i < 0 || moments.x_m[i] === null) return;
      const [px, py] = toPixel(moments.x_m[i], moments.y_m[i]);
      const yaw = (moments.yaw_deg[i] * Math.PI) / 180;
      context.strokeStyle = runColours[k];
      context.fillStyle = runColours[k];
      context.lineWidth = 2;
      context.beginPath();
      const [sx, sy] = [moments.std_x_m[i], moments.std_y_m[i]];
      const ellipse = ellipseOf(sx * sx, (moments.correlation_xy[i] || 0) * sx * sy, sy * sy);
      const size = 3 * view.scale;
      context.ellipse(px, py, Math.max(size * ellipse.long, 3), Math.max(size * ellipse.short, 3), -ellipse.angle, 0, 2 * Math.PI);
      context.moveTo(px, py);
      context.lineTo(px + 18 * Math.cos(yaw), py - 18 * Math.sin(yaw));
      context.stroke();
    });
  };

  function drawMap() {
    if (!canvas.clientWidth) return;
    [view.width, view.height] = [canvas.clientWidth, canvas.clientHeight];
    const ratio = window.devicePixelRatio || 1;
    canvas.width = canvas.clientWidth * ratio;
    canvas.height = canvas.clientHeight * ratio;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    drawGrid();
    for (const layer of layers) if (layer.box.checked) layer.draw();
    drawMarked();
    drawScaleBar();
  }

  const showAll = () => {
    const low = [Infinity, Infinity];
    const high = [-Infinity, -Infinity];
    for (const each of run.runs) {
      each.path.x_m.forEach((x, i) => {
        if (x === null) return;
        const point = [x, each.path.y_m[i]];
        point.forEach((value, axis) => {
          low[axis] = Math.min(low[axis], value);
          high[axis] = Math.max(high[axis], value);
        });
      });
    }
    if (!Number.isFinite(low[0])) [low[0], low[1], high[0], high[1]] = [-1, -1, 1, 1];
    view.centre = [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2];
    const span = [Math.max(high[0] - low[0], 0.1), Math.max(high[1] - low[1], 0.1)];
    view.scale = 0.9 * Math.min(canvas.clientWidth / span[0], canvas.clientHeight / span[1]);
    drawMap();
  };

  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY * 0.0015);
    view.zoom(factor, [event.offsetX, event.offsetY]);
    drawMap();
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => {
    if (!(event.buttons & 1)) return;
    view.move(event.movementX, event.movementY);
    drawMap();
  });
  canvas.addEventListener("dblclick", showAll);
  window.addEventListener("resize", drawMap);
  showAll();
})();
