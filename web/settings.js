// The settings of the fusion: shown, and changed where the server allows it.
"use strict";

(() => {
  const { element, clockText } = sonopose;

  class Settings {
    // `request(object)` sends to the server; false if there is no connection.
    constructor(parts, table, request) {
      this.parts = parts;
      this.table = table;
      this.request = request;
      this.values = new Map(); // by address or "all": texts by key
      this.isAllowed = false;
      this.nextId = 1;
      this.pending = new Map(); // requests by id: {line, key}
      this.wanted = null; // address to show again after a connection was lost
      this.inputs = new Map(); // by key
      this.build();
    }

    build() {
      const groups = new Map();
      for (const row of this.table) groups.set(row.group, [...(groups.get(row.group) || []), row]);
      for (const [name, rows] of groups) {
        const box = element("details", {}, [element("summary", { textContent: name })]);
        for (const row of rows) box.append(this.makeRow(row));
        this.parts.list.append(box);
      }
      this.parts.search.addEventListener("input", () => this.filter());
      this.parts.of.addEventListener("change", () => {
        this.wanted = null;
        this.show();
      });
      this.parts.reset.addEventListener("click", () => {
        const isSure = this.parts.of.value !== "all" || window.confirm("Reset the estimators of all beacons?");
        if (isSure) this.send({ op: "reset" }, "reset");
      });
      this.addAddress("all");
    }

    makeRow(row) {
      const input = row.type === "choice" || row.type === "bool"
        ? element("select", {}, (row.choices || ["true", "false"]).map((choice) => element("option", { textContent: choice })))
        : element("input", { type: "text", inputMode: "decimal" });
      input.setAttribute("aria-label", row.key);
      input.disabled = true;
      input.addEventListener("change", () => {
        this.send({ op: "change", assignments: { [row.key]: input.value } }, `${row.key}=${input.value}`, row.key);
      });
      this.inputs.set(row.key, input);
      const item = row.item ? `${row.item}. ` : "";
      const line = element("div", { className: "setting" }, [
        element("span", { textContent: row.key.slice(row.group.length + 1) }),
        element("span", { className: "value" }, [input, row.unit]),
        element("span", { className: "about", textContent: `${item}${row.sentence} ${row.allowed}; default ${row.default}.` }),
      ]);
      line.dataset.text = `${row.key} ${row.sentence}`.toLowerCase();
      return line;
    }

    filter() {
      const wanted = this.parts.search.value.trim().toLowerCase();
      for (const box of this.parts.list.children) {
        let shown = 0;
        for (const line of box.querySelectorAll(".setting")) {
          line.hidden = !line.dataset.text.includes(wanted);
          if (!line.hidden) shown += 1;
        }
        box.hidden = shown === 0;
        box.open = wanted !== "" && shown > 0;
      }
    }

    addAddress(address) {
      const text = address === "all" ? "all beacons" : `beacon ${address}`;
      if ([...this.parts.of.options].some((option) => option.value === String(address))) return;
      this.parts.of.append(element("option", { value: String(address), textContent: text }));
      if (String(address) === this.wanted) {
        this.parts.of.value = this.wanted;
        this.wanted = null;
      }
    }

    forget(address) {
      this.values.delete(String(address));
      const option = [...this.parts.of.options].find((each) => each.value === String(address));
      if (option) option.remove();
      // Nothing is selected then: a value that is being typed must not reach another beacon.
      if (option && ![...this.parts.of.options].some((each) => each.selected)) this.parts.of.value = "";
      this.show();
    }

    // Forgets the previous connection's values: the server sends those that still exist again.
    clear() {
      this.wanted = this.parts.of.value;
      for (const address of [...this.values.keys()]) if (address !== "all") this.forget(address);
      this.values.clear();
      this.show();
    }

    // It is not known if the fusion received the requests.
    onLost() {
      for (const id of [...this.pending.keys()]) {
        this.onReply({ id, accepted: false, reason: "the connection was lost before the answer; see the value" });
      }
    }

    allow(isAllowed) {
      this.isAllowed = isAllowed;
      this.parts.note.textContent = isAllowed
        ? "A change takes effect immediately, and lasts until the fusion ends."
        : "To change settings here, start sonopose-web with --allow-changes.";
      this.parts.reset.disabled = !isAllowed;
      for (const input of this.inputs.values()) input.disabled = !isAllowed;
    }

    onSettings(message) {
      this.values.set(String(message.address), message.values);
      this.addAddress(message.address);
      this.show();
    }

    // An input that somebody is changing keeps its text, but not that of `refused`, whose value did not change.
    show(refused = null) {
      const values = this.values.get(this.parts.of.value) || {};
      for (const row of this.table) {
        const input = this.inputs.get(row.key);
        if (document.activeElement === input && row.key !== refused) continue;
        input.value = values[row.key] ?? "";
        input.classList.toggle("changed", values[row.key] !== undefined && values[row.key] !== String(row.default));
      }
    }

    // `key`: the setting that it changes.
    send(request, text, key = null) {
      const selected = this.parts.of.value;
      const address = selected === "all" ? "all" : Number(selected);
      const name = { all: "all beacons", "": "no beacon" }[selected] || `beacon ${selected}`;
      const id = this.nextId++;
      const line = element("li", {}, [
        element("time", { textContent: clockText(Date.now() / 1000) }),
        element("span", { textContent: `${text} for ${name}: ` }),
        element("span", { textContent: "waiting" }),
      ]);
      this.parts.requests.prepend(line);
      if (this.parts.requests.children.length > 20) this.parts.requests.lastChild.remove();
      this.pending.set(id, { line, key });
      if (selected === "") {  // its beacon has gone
        this.onReply({ id, accepted: false, reason: "select a beacon" });
      } else if (!this.request({ ...request, id, address })) {
        this.onReply({ id, accepted: false, reason: "no connection" });
      }
    }

    onReply(reply) {
      const request = this.pending.get(reply.id);
      if (!request) return;
      const { line, key } = request;
      this.pending.delete(reply.id);
      line.className = reply.accepted ? "accepted" : "refused";
      const from = reply.details || (reply.from_event ? `from event ${reply.from_event}` : "");
      const answer = reply.accepted ? ["accepted", from, reply.reason] : ["refused", reply.reason];
      line.lastChild.textContent = answer.filter(Boolean).join("; ");
      if (!reply.accepted) this.show(key);
    }
  }

  sonopose.Settings = Settings;
})();
