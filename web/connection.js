// The WebSocket to the server; connects again by itself.
"use strict";

(() => {
  const token = new URLSearchParams(location.search).get("token");
  const query = token === null ? "" : `?token=${encodeURIComponent(token)}`;

  // Where a file of the server is, with the token.
  const urlOf = (path) => path + query;

  const fetchJson = async (path) => {
    const response = await fetch(urlOf(path));
    if (!response.ok) throw new Error(`${path}: ${await response.text()}`);
    return response.json();
  };

  class Connection {
    // `handlers`: onMessage(object) and onState(text, isConnected).
    constructor(handlers) {
      this.handlers = handlers;
      this.waitS = 0.25;
      this.open();
    }

    open() {
      this.handlers.onState("connecting", false);
      const scheme = location.protocol === "https:" ? "wss:" : "ws:";
      this.socket = new WebSocket(`${scheme}//${location.host}/ws${query}`, "sonopose.v1");
      this.socket.onopen = () => {
        this.waitS = 0.25;
        this.handlers.onState("connected", true);
      };
      this.socket.onmessage = (event) => this.handlers.onMessage(JSON.parse(event.data));
      this.socket.onclose = () => {
        this.handlers.onState(`connection lost, trying again in ${this.waitS} s`, false);
        setTimeout(() => this.open(), 1000 * this.waitS);
        this.waitS = Math.min(4, 2 * this.waitS);
      };
    }

    send(object) {
      if (this.socket.readyState !== WebSocket.OPEN) return false;
      this.socket.send(JSON.stringify(object));
      return true;
    }
  }

  Object.assign(sonopose, { Connection, urlOf, fetchJson });
})();
