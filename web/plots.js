// Time plots of the selected beacon. All show the same part of the time: the latest, or what somebody chose.
"use strict";

(() => {
  const { element, verdicts, truthColour: green } = sonopose;
  const spans = [["1 min", 60], ["10 min", 600], ["all", Infinity]]; // that are followed, s
  const mostPoints = 1500;

  const speed = (row) => Math.hypot(row.vx, row.vy, row.vz);
  const innovation = (row) => Math.hypot(row.ix, row.iy, row.iz);
  const blue = "#1f77d0";

  const mostDelayS = 10; // delays beyond it, of either sign, are faults of a clock

  const delay = (row) => {
    const passedS = row.t - row.t_emission;
    return Math.abs(passedS) <= mostDelayS ? 1e3 * passedS : NaN;
  };

  // Each plot: its curves, and of which rows they are; `line` has curves of other rows.
  const definitions = [
    { name: "Height", unit: "m", rows: "poses", curves: [["z", (row) => row.z, blue]] },
    { name: "Speed", unit: "m/s", rows: "poses", curves: [["speed", speed, blue]] },
    {
      name: "Innovation of fixes", unit: "m", rows: "fixes", isDotted: true,
      curves: verdicts.map(({ name, colour }, verdict) => [name, (row) => (row.verdict === verdict ? innovation(row) : NaN), colour]),
    },
    { name: "Trust", unit: "", rows: "poses", curves: [["trust", (row) => row.trust, blue]], range: [0, 1.05] },
    {
      name: "Latency, median", unit: "ms", rows: "status",
      curves: [
        ["sensor to bridge", (row) => 1e3 * row.sensor_to_bridge, "#8796a5"],
        ["to the fusion", (row) => 1e3 * row.bridge_to_fusion, blue],
        ["in the fusion", (row) => 1e3 * row.in_fusion, green],
        ["to here", (row) => 1e3 * row.fusion_to_here, "#d0571f"],
      ],
    },
    {
      name: "Delay of the fixes", unit: "ms", rows: "fixes", isDotted: true,
      curves: [["applied after emission", delay, blue]],
      line: { rows: "status", curves: [["estimate of the fusion", (row) => 1e3 * row.delay, green]] },
    },
    { name: "Battery", unit: "V", rows: "status", curves: [["battery", (row) => row.battery, blue]] },
  ];

  const partsOf = (definition) => (definition.line ? [definition, definition.line] : [definition]);
  const curvesOf = (definition) => partsOf(definition).flatMap(({ curves }) => curves);

  class Plots {
    constructor(container, model) {
      this.container = container;
      this.model = model;
      this.zoomed = null; // [from, to] in ms that somebody chose, or null: follows
      this.spanS = 60;
      this.shownRange = null; // the range that was set last
      this.isDrawing = false;
      this.address = null;
      this.makeTools();
      this.graphs = definitions.map((definition) => this.makePlot(definition));
    }

    makeTools() {
      this.title = element("b");
      this.buttons = spans.map(([textContent, spanS]) => {
        const button = element("button", { type: "button", textContent, title: `Follow the latest: ${textContent}` });
        button.addEventListener("click", () => this.follow(spanS));
        return button;
      });
      const hint = element("span", { textContent: "Ctrl and wheel: zoom; drag: choose; Shift and drag: move; double click: follow" });
      this.container.append(element("p", { className: "plot-tools" }, [this.title, ...this.buttons, hint]));
      this.markButtons();
    }

    markButtons() {
      this.buttons.forEach((button, i) => {
        button.setAttribute("aria-pressed", String(this.zoomed === null && this.spanS === spans[i][1]));
      });
    }

    makePlot(definition) {
      const graph = element("div", { className: "graph" });
      const box = element("div", { className: "plot", hidden: true }, [
        element("h2", { textContent: definition.unit ? `${definition.name} (${definition.unit})` : definition.name }),
        graph,
      ]);
      this.container.append(box);
      return { definition, box, graph, dygraph: null, address: null };
    }

    // About `mostPoints` rows in the range, and whether a curve has a value. Of the fixes only used ones are left out.
    rowsOf(definition, columns, [from, to]) {
      const begin = Math.max(0, columns.count(from / 1000) - 1);
      const end = Math.min(columns.size, columns.count(to / 1000) + 1);
      const step = Math.ceil((end - begin) / mostPoints) || 1;
      const first = columns.pushed - columns.size; // the same rows are shown while the range moves
      const rows = [];
      let hasValues = false;
      for (let i = begin; i < end; i += 1) {
        const isRemarkable = i === end - 1 || (definition.isDotted && columns.get("verdict", i) !== 0);
        if ((first + i) % step !== 0 && !isRemarkable) continue;
        const row = columns.row(i);
        const values = definition.curves.map(([, value]) => value(row));
        hasValues = hasValues || values.some(Number.isFinite);
        rows.push([new Date(1000 * row.t), ...values.map((value) => (Number.isFinite(value) ? value : null))]);
      }
      return { rows, hasValues };
    }

    // The same of all parts, by time. A part has no values in the rows of another.
    rowsOfAll(definition, beacon, range) {
      const unknowns = curvesOf(definition).map(() => null);
      let before = 0; // curves of the parts so far
      let hasValues = false;
      const all = partsOf(definition).flatMap((part) => {
        const first = before;
        const found = this.rowsOf(part, beacon[part.rows], range);
        hasValues = hasValues || found.hasValues;
        const padded = found.rows.map(([time, ...values]) => [time, ...unknowns.map((_, i) => values[i - first] ?? null)]);
        before += part.curves.length;
        return padded;
      });
      return { rows: all.sort((a, b) => a[0] - b[0]), hasValues };
    }

    range(beacon) {
      if (this.zoomed) return this.zoomed;
      const { now, extent } = this.model;
      if (extent) {
        const length = Math.min(this.spanS, extent[1] - extent[0]);
        const from = Math.min(Math.max(extent[0], now - length / 2), extent[1] - length);
        return [1000 * from, 1000 * (from + length)];
      }
      const times = [beacon.poses, beacon.status].filter(({ size }) => size > 0);
      const last = Math.max(0, ...times.map((columns) => columns.last().t));
      const first = Math.min(last, ...times.map((columns) => columns.get("t", 0)));
      return [1000 * (this.spanS === Infinity ? first : last - this.spanS), 1000 * last];
    }

    draw() {
      if (this.container.hidden) return;
      const beacon = this.model.beacons.get(this.model.selected);
      this.title.textContent = beacon ? `Beacon ${beacon.address}` : "No beacon";
      if (this.address !== beacon?.address) this.zoomed = null;
      this.address = beacon?.address ?? null;
      this.markButtons();
      if (beacon) this.shownRange = this.range(beacon);
      this.isDrawing = true;
      for (const plot of this.graphs) {
        if (beacon) this.drawPlot(plot, beacon);
        else plot.box.hidden = true;
      }
      this.isDrawing = false;
    }

    // A plot without values is hidden, unless it only has none in the range that somebody chose.
    drawPlot(plot, beacon) {
      const { definition } = plot;
      const dateWindow = this.shownRange;
      const { rows, hasValues } = this.rowsOfAll(definition, beacon, dateWindow);
      const isKept = plot.dygraph && plot.address === beacon.address && this.zoomed !== null && !plot.box.hidden;
      plot.box.hidden = !hasValues && !isKept;
      if (plot.box.hidden) return;
      plot.address = beacon.address;
      if (rows.length === 0) rows.push([new Date(dateWindow[0]), ...curvesOf(definition).map(() => null)]);
      if (plot.dygraph) {
        if (plot.dygraph.size().width !== plot.graph.clientWidth) plot.dygraph.resize(); // it was hidden meanwhile
        plot.dygraph.updateOptions({ file: rows, dateWindow });
        return;
      }
      const labels = ["time", ...curvesOf(definition).map(([name]) => name)];
      const lines = (definition.line?.curves ?? []).map(([name]) => [name, { drawPoints: false, strokeWidth: 1.5, connectSeparatedPoints: true }]);
      plot.dygraph = new Dygraph(plot.graph, rows, {
        labels,
        series: Object.fromEntries(lines),
        colors: curvesOf(definition).map(([, , colour]) => colour),
        dateWindow,
        legend: "always",
        drawPoints: Boolean(definition.isDotted),
        strokeWidth: definition.isDotted ? 0 : 1.5,
        pointSize: 2,
        connectSeparatedPoints: !definition.isDotted,
        valueRange: definition.range || null,
        includeZero: !["Height", "Battery"].includes(definition.name),
        axes: { x: { axisLabelWidth: 70 }, y: { axisLabelWidth: 44 } },
        animatedZooms: false,
        interactionModel: {
          ...Dygraph.defaultInteractionModel,
          dblclick: () => this.follow(),
          wheel: (event, dygraph) => this.onWheel(event, dygraph),
        },
        drawCallback: (dygraph, isInitial) => this.onDraw(plot, dygraph, isInitial),
        underlayCallback: (context, area, dygraph) => this.drawNow(context, area, dygraph),
      });
    }

    // Around the pointer, with Ctrl: without it the wheel scrolls the panel.
    onWheel(event, dygraph) {
      if (!event.ctrlKey) return;
      event.preventDefault();
      const factor = Math.exp(0.0015 * event.deltaY);
      const at = dygraph.toDataXCoord(event.offsetX);
      const range = dygraph.xAxisRange().map((t) => at + (t - at) * factor);
      if (range[1] - range[0] > 50) this.choose(range);
    }

    // A pan and a zoom by drag have no other sign than a range that was not asked for. A hidden plot has an old one.
    onDraw(plot, dygraph, isInitial) {
      if (isInitial || this.isDrawing || plot.box.hidden) return;
      const range = dygraph.xAxisRange();
      if (range.some((t, i) => Math.abs(t - this.shownRange[i]) > 1)) this.choose(range);
    }

    choose(range) {
      this.zoomed = range;
      this.shownRange = range;
      this.model.isNew = true;
    }

    // The time that is shown of a recording.
    drawNow(context, area, dygraph) {
      if (this.model.now === null) return;
      const left = dygraph.toDomXCoord(1000 * this.model.now);
      context.fillStyle = "#d0571f";
      context.fillRect(left, area.y, 1, area.h);
    }

    follow(spanS = this.spanS) {
      this.zoomed = null;
      this.spanS = spanS;
      this.model.isNew = true;
    }
  }

  sonopose.Plots = Plots;
})();
