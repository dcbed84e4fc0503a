// Changes of state, lines of logs, warnings, and what the doctor finds.
"use strict";

(() => {
  const { element, clockText } = sonopose;
  const mostEvents = 500;

  const mostPrograms = 32; // to choose from
  const levels = ["info", "warning", "error"];

  const nameOf = ({ program }) => (program || "").replace(/^sonopose-/, "");
  const processOf = ({ host, pid }) => `${host}:${pid}`;

  const missingText = (count) => (count === 1 ? "1 line is missing" : `${count} lines are missing`);

  // Events, and lines of the logs of all processes.
  class Events {
    // `parts`: list, warnings, and the choices level and program.
    constructor(parts) {
      Object.assign(this, parts);
      this.clear();
      this.untilS = Infinity; // later lines are hidden
      for (const choice of [this.level, this.program]) choice.addEventListener("change", () => this.filter());
    }

    clear() {
      this.lines = []; // by time, the newest first, as in the list
      this.arrived = []; // the same by arrival: the clocks of other machines do not decide which are kept
      this.processes = new Map(); // by program: how many lines each of its processes has
      this.list.replaceChildren();
    }

    // Lines that were lost before this one are a line of their own.
    add(event) {
      if (event.missing > 0) this.insert({ ...event, level: "warning", text: missingText(event.missing) });
      this.insert(event);
    }

    // The newest comes first, also if an older one arrives later.
    insert(event) {
      const same = this.sameOf(event);
      if (same) {
        same.others.push(event);
        this.label(same);
        return;
      }
      const label = element("b", { textContent: nameOf(event) });
      const item = element("li", { className: event.level, hidden: !this.isShown(event) }, [
        element("time", { textContent: clockText(event.t) }), label, element("span", { textContent: event.text }),
      ]);
      const line = { event, item, label, others: [] };
      const at = this.countAfter(event.t);
      this.list.insertBefore(item, this.lines[at]?.item || null);
      this.lines.splice(at, 0, line);
      this.arrived.push(line);
      this.offer(nameOf(event));
      if (this.count(line, 1)) this.labelAll(nameOf(event));
      else this.label(line);
      if (this.arrived.length > mostEvents) this.removeFirst();
    }

    // The same line of another process of the program within a second: an active fusion and its standby say the same.
    sameOf(event) {
      for (let at = this.countAfter(event.t + 1); at < this.lines.length; at += 1) {
        const line = this.lines[at];
        if (line.event.t < event.t - 1) return null;
        const isSame = line.event.text === event.text && nameOf(line.event) === nameOf(event);
        if (isSame && ![line.event, ...line.others].some((each) => processOf(each) === processOf(event))) return line;
      }
      return null;
    }

    // The one that arrived first.
    removeFirst() {
      const line = this.arrived.shift();
      this.lines.splice(this.lines.lastIndexOf(line), 1);
      line.item.remove();
      if (this.count(line, -1)) this.labelAll(nameOf(line.event));
    }

    // Number of lines later than `t`.
    countAfter(t) {
      let low = 0;
      let high = this.lines.length;
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.lines[middle].event.t > t) low = middle + 1;
        else high = middle;
      }
      return low;
    }

    // Counts a line that comes (1) or goes (-1). Returns whether all labels of its program change.
    count({ event }, step) {
      const name = nameOf(event);
      const counts = this.processes.get(name) || new Map();
      const wereSeveral = counts.size > 1;
      const lines = (counts.get(processOf(event)) || 0) + step;
      if (lines > 0) counts.set(processOf(event), lines);
      else counts.delete(processOf(event));
      if (counts.size > 0) this.processes.set(name, counts);
      else this.processes.delete(name);
      return wereSeveral !== counts.size > 1;
    }

    // Names the processes too, if there are several of the program.
    label({ event, label, others }) {
      const name = nameOf(event);
      const isOneOfSeveral = name && (others.length > 0 || this.processes.get(name).size > 1);
      const text = isOneOfSeveral ? `${name} ${[event, ...others].map(processOf).join(", ")}` : name;
      if (label.textContent !== text) label.textContent = text;
    }

    labelAll(name) {
      for (const line of this.lines) {
        if (nameOf(line.event) === name) this.label(line);
      }
    }

    offer(name) {
      const { options } = this.program;
      if (!name || options.length >= mostPrograms || [...options].some(({ value }) => value === name)) return;
      this.program.append(element("option", { value: name, textContent: name }));
    }

    isChosen(event) {
      const isOfLevel = levels.indexOf(event.level) >= levels.indexOf(this.level.value);
      return isOfLevel && (this.program.value === "" || this.program.value === nameOf(event));
    }

    isShown(event) {
      return event.t <= this.untilS && this.isChosen(event);
    }

    filter(lines = this.lines) {
      for (const { event, item } of lines) item.hidden = !this.isShown(event);
    }

    // Hides the lines after this time (s), and shows those before it again.
    showUntil(timeS) {
      if (timeS === this.untilS) return;
      const [from, to] = [this.untilS, timeS].map((t) => this.countAfter(t)).sort((a, b) => a - b);
      this.untilS = timeS;
      this.filter(this.lines.slice(from, to));
    }

    showWarnings(texts) {
      this.warnings.replaceChildren(...texts.map((text) => element("li", { className: "warning", textContent: text })));
    }
  }

  class Findings {
    constructor(list, progress, button, examine) {
      this.list = list;
      this.progress = progress;
      this.button = button;
      button.addEventListener("click", () => {
        if (!examine()) return;
        this.show({ running: true, share: 0, findings: [] });
      });
    }

    // The doctor may continue, but its findings do not arrive.
    onLost() {
      this.progress.hidden = true;
      this.button.disabled = false;
    }

    show(report) {
      this.progress.hidden = !report.running;
      this.progress.value = report.share;
      this.button.disabled = report.running;
      if (report.running) return;
      this.list.replaceChildren(...report.findings.map((finding) => {
        const line = element("li", {}, [
          element("b", { className: finding.severity, textContent: `${finding.severity}: ` }),
          `${finding.subject}: ${finding.what}`,
        ]);
        if (finding.remedy) line.append(element("p", { textContent: finding.remedy }));
        return line;
      }));
    }
  }

  Object.assign(sonopose, { Events, Findings });
})();
