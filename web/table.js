// The table of beacons.
"use strict";

(() => {
  const { element, format, words, hasHeading, badSeverity, compareKnown } = sonopose;

  const columns = [
    { name: "beacon", key: (beacon) => beacon.address, text: (beacon) => String(beacon.address) },
    { name: "x", value: ({ pose }) => pose?.x, digits: 2, unit: "m" },
    { name: "y", value: ({ pose }) => pose?.y, digits: 2, unit: "m" },
    { name: "z", value: ({ pose }) => pose?.z, digits: 2, unit: "m" },
    { name: "heading", value: ({ pose }) => (pose && hasHeading(pose) ? (pose.yaw * 180) / Math.PI : NaN), digits: 0, unit: "°" },
    { name: "speed", value: ({ pose }) => pose && Math.hypot(pose.vx, pose.vy, pose.vz), digits: 2, unit: "m/s" },
    { name: "σ", value: ({ pose }) => pose && 100 * Math.sqrt(pose.cxx + pose.cyy + pose.czz), digits: 1, unit: "cm" },
    { name: "innovation", value: ({ fix }) => fix && 100 * Math.hypot(fix.ix, fix.iy, fix.iz), digits: 1, unit: "cm" },
    { name: "trust", value: ({ pose }) => pose?.trust, digits: 2 },
    { name: "battery", value: ({ state }) => state?.battery, digits: 2, unit: "V" },
    { name: "status" },
  ];

  class Table {
    constructor(table, model) {
      this.model = model;
      this.order = "worst";
      this.isDescending = false;
      this.rows = new Map();
      const heads = columns.map((column) => {
        const button = element("button", { type: "button", textContent: column.name, title: `Sort by ${column.name}` });
        button.addEventListener("click", () => this.sortBy(column.name));
        return element("th", { scope: "col" }, [button]);
      });
      this.body = element("tbody");
      table.append(element("thead", {}, [element("tr", {}, heads)]), this.body);
    }

    sortBy(name) {
      const order = name === "status" ? "worst" : name;
      this.isDescending = this.order === order ? !this.isDescending : false;
      this.order = order;
      this.model.isNew = true;
    }

    rowOf(beacon) {
      let row = this.rows.get(beacon.address);
      if (row) return row;
      const line = element("tr", { tabIndex: 0 });
      const cells = columns.map(() => element("td"));
      const mark = element("i");
      mark.style.background = beacon.colour;
      line.append(...cells);
      const select = () => this.model.select(beacon.address);
      line.addEventListener("click", select);
      line.addEventListener("keydown", (event) => {
        if (event.key === "Enter") select();
      });
      row = { line, cells, mark };
      this.rows.set(beacon.address, row);
      return row;
    }

    // Live, as the monitor has it.
    statusOf(beacon, pose) {
      const { latest } = beacon;
      if (latest && this.model.extent === null) return { text: latest.stream, severity: latest.severity };
      return pose ? words(pose.status) : { text: "no pose", severity: 100 };
    }

    draw() {
      const { model } = this;
      const entries = [...model.beacons.values()].map((beacon) => {
        const pose = beacon.poses.last(model.shown);
        const status = this.statusOf(beacon, pose);
        const outside = pose && model.isOutside(pose) ? ", outside" : "";
        const [fix, state] = [beacon.fixes, beacon.status].map((columns) => columns.last(model.shown));
        return { beacon, pose, fix, state, status, text: status.text + outside };
      });
      const column = columns.find(({ name }) => name === this.order);
      const keyOf = (entry) => {
        if (this.order === "worst") return -entry.status.severity;
        return column.key ? column.key(entry.beacon) : (column.value(entry) ?? NaN);
      };
      entries.sort((a, b) => compareKnown(keyOf(a), keyOf(b), this.isDescending) || a.beacon.address - b.beacon.address);
      entries.forEach((entry, at) => this.drawRow(entry, at));
      for (const [address, row] of this.rows) {
        if (model.beacons.has(address)) continue;
        row.line.remove();
        this.rows.delete(address);
      }
    }

    drawRow(entry, at) {
      const row = this.rowOf(entry.beacon);
      row.line.setAttribute("aria-selected", String(entry.beacon.address === this.model.selected));
      columns.forEach((column, i) => {
        const cell = row.cells[i];
        let text = "";
        if (column.name === "status") {
          text = entry.text;
          const { severity } = entry.status;
          cell.className = severity >= badSeverity ? "bad" : severity > 0 ? "fair" : "";
        } else {
          text = column.text ? column.text(entry.beacon) : format(column.value(entry) ?? NaN, column.digits, column.unit);
        }
        if (row.cells[i].dataset.text === text) return;
        cell.dataset.text = text;
        if (i === 0) cell.replaceChildren(row.mark, text);
        else cell.textContent = text;
      });
      if (this.body.children[at] !== row.line) this.body.insertBefore(row.line, this.body.children[at] || null);
    }
  }

  sonopose.Table = Table;
})();
