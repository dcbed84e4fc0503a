// Time plots of the selected beacon. All show the same part of the time.
"use strict";

(() => {
  const { element } = sonopose;
  const windowS = 60; // that is shown until somebody zooms
  const mostPoints = 1500;

  const speed = (row) => Math.hypot(row.vx, row.vy, row.vz);
  const innovation = (row) => Math.hypot(row.ix, row.iy, row.iz);
  const blue = "#1f77d0";
  const green = "#2d9a4b";

  // Each plot: its curves, and of which rows they are.
  const definitions = [
    { name: "Height", unit: "m", rows: "poses", curves: [["z", (row) => row.z, blue]] },
    { name: "Speed", unit: "m/s", rows: "poses", curves: [["speed", speed, blue]] },
    {
      name: "Innovation of fixes", unit: "m", rows: "fixes", isDotted: true,
      curves: [
        ["used", (row) => (sonopose.verdictOf(row) === "used" ? innovation(row) : NaN), "#8796a5"],
        ["down-weighted", (row) => (sonopose.verdictOf(row) === "weak" ? innovation(row) : NaN), "#e0a100"],
        ["rejected", (row) => (sonopose.verdictOf(row) === "rejected" ? innovation(row) : NaN), "#d62839"],
      ],
    },
    { name: "Trust", unit: "", rows: "poses", curves: [["trust", (row) => row.trust, blue]], range: [0, 1.05] },
    {
      name: "Latency, median", unit: "ms", rows: "status",
      curves: [
        ["sensor to bridge", (row) => 1e3 * row.sensor_to_bridge, "#8796a5"],
        ["to the fusion", (row) => 1e3 * row.bridge_to_fusion, blue],
        ["in the fusion", (row) => 1e3 * row.fusion, green],
        ["to here", (row) => 1e3 * row.fusion_to_here, "#d0571f"],
      ],
    },
    { name: "Delay of the fixes", unit: "ms", rows: "status", curves: [["delay", (row) => 1e3 * row.delay, blue]] },
    { name: "Battery", unit: "V", rows: "status", curves: [["battery", (row) => row.battery, blue]] },
  ];

  class Plots {
    constructor(container, model) {
      this.container = container;
      this.model = model;
      this.graphs = definitions.map((definition) => this.makePlot(definition));
      this.zoomed = null; // [from, to] in ms, or null: follows
      this.isSynchronising = false;
      this.address = null;
    }

    makePlot(definition) {
      const graph = element("div", { className: "graph" });
      const box = element("div", { className: "plot", hidden: true }, [
        element("h2", { textContent: definition.unit ? `${definition.name} (${definition.unit})` : definition.name }),
        graph,
      ]);
      this.container.append(box);
      return { definition, box, graph, dygraph: null };
    }

    // At most `mostPoints` rows in the range, and whether a curve has a value.
    rowsOf(definition, columns, [from, to]) {
      const begin = columns.count(from / 1000 - 1);
      const end = Math.min(columns.size, columns.count(to / 1000) + 1);
      const step = definition.isDotted ? 1 : Math.ceil((end - begin) / mostPoints) || 1;
      const rows = [];
      let hasValues = false;
      for (let i = begin; i < end; i += step) {
        const row = columns.row(i);
        const values = definition.curves.map(([, value]) => value(row));
        hasValues = hasValues || values.some(Number.isFinite);
        rows.push([new Date(1000 * row.t), ...values.map((value) => (Number.isFinite(value) ? value : null))]);
      }
      return { rows, hasValues };
    }

    range(beacon) {
      if (this.zoomed) return this.zoomed;
      const { now } = this.model;
      const last = beacon.poses.last() || beacon.status.last();
      if (now === null) return [1000 * ((last ? last.t : 0) - windowS), 1000 * (last ? last.t : 0)];
      const [begin, end] = this.model.extent;
      const length = Math.min(windowS, end - begin);
      const from = Math.min(Math.max(begin, now - length / 2), end - length);
      return [1000 * from, 1000 * (from + length)];
    }

    draw() {
      const beacon = this.model.beacons.get(this.model.selected);
      if (!beacon || this.container.hidden) return;
      if (this.address !== beacon.address) this.zoomed = null;
      this.address = beacon.address;
      const dateWindow = this.range(beacon);
      this.isSynchronising = true;
      for (const plot of this.graphs) this.drawPlot(plot, beacon, dateWindow);
      this.isSynchronising = false;
    }

    drawPlot(plot, beacon, dateWindow) {
      const { definition } = plot;
      const { rows, hasValues } = this.rowsOf(definition, beacon[definition.rows], dateWindow);
      plot.box.hidden = !hasValues && !plot.dygraph;
      if (rows.length === 0 || plot.box.hidden) return;
      if (plot.dygraph) {
        plot.dygraph.updateOptions({ file: rows, dateWindow });
        return;
      }
      const labels = ["time", ...definition.curves.map(([name]) => name)];
      plot.dygraph = new Dygraph(plot.graph, rows, {
        labels,
        colors: definition.curves.map(([, , colour]) => colour),
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
        zoomCallback: () => this.onZoom(plot),
        drawCallback: (dygraph, isInitial) => this.onDraw(dygraph, isInitial),
        underlayCallback: (context, area, dygraph) => this.drawNow(context, area, dygraph),
      });
    }

    onZoom(plot) {
      this.zoomed = plot.dygraph.isZoomed("x") ? plot.dygraph.xAxisRange() : null;
      this.model.isNew = true;
    }

    // A pan has no callback of its own.
    onDraw(dygraph, isInitial) {
      if (isInitial || this.isSynchronising) return;
      this.zoomed = dygraph.xAxisRange();
    }

    // The time that is shown of a recording.
    drawNow(context, area, dygraph) {
      if (this.model.now === null) return;
      const left = dygraph.toDomXCoord(1000 * this.model.now);
      context.fillStyle = "#d0571f";
      context.fillRect(left, area.y, 1, area.h);
    }

    follow() {
      this.zoomed = null;
    }
  }

  sonopose.Plots = Plots;
})();
